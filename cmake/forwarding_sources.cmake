# SPDX-License-Identifier: Apache-2.0
# Sources with one function for each of OpenGL's 3,300 commands (dispatch/call_words.h, dispatch/pass_through.h). The
# functions only forward their arguments: -O2 compiles twice as long as -O1 and does not make them faster.

# compile_forwarding(SOURCE...): for sources of this folder's targets that are not executed for a viewer's calls.
function(compile_forwarding)
  if(UNDERSTUDY_SANITIZE)
    # Sanitizer builds optimise less anyway; sources are kept out of groups like others with options of their own.
    set_property(SOURCE ${ARGN} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
    return()
  endif()
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS $<$<NOT:$<CONFIG:Debug>>:-O1>)
endfunction()
