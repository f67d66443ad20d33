# SPDX-License-Identifier: Apache-2.0
# From nothing, most of what compiling takes are headers and templates that many sources share. Compiled in groups, they
# are read and instantiated once a group. `./run` builds so; who works on sources and compiles one after the other does
# not need it.
option(UNDERSTUDY_GROUPS "Compile sources in groups: less work from nothing, more after a change" OFF)

# compile_in_groups(TARGET [SIZE NUMBER] [APART SOURCE…]): in groups of NUMBER; the more, the more likely two sources have a
# name of their own that is the same. APART are sources with names of their own that another source of the group
# has too, and those that are compiled once for each instruction set.
function(compile_in_groups target)
  cmake_parse_arguments(ARG "" "SIZE" "APART" ${ARGN})
  if(NOT UNDERSTUDY_GROUPS)
    return()
  endif()
  if(NOT ARG_SIZE)
    set(ARG_SIZE 40)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ARG_SIZE})
  # gcc takes a source that is included for a header, whose unnamed namespaces would be another's in every user.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
