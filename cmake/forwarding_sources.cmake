# SPDX-License-Identifier: Apache-2.0
# Sources that make a function for each of OpenGL's 3,300 commands (dispatch/call_words.h, dispatch/pass_through.h). The
# functions only hand their arguments on: -O2 takes twice the time of -O1 and makes them no better.

# compile_forwarding(SOURCE…): sources of this folder's targets; for those that are not on the way of a viewer's calls.
function(compile_forwarding)
  if(UNDERSTUDY_SANITIZE)
    # Nothing is optimised further there; by themselves, as sources with options of their own are.
    set_property(SOURCE ${ARGN} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
    return()
  endif()
  set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS $<$<NOT:$<CONFIG:Debug>>:-O1>)
endfunction()
