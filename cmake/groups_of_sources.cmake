# SPDX-License-Identifier: Apache-2.0
# In a full build, most of the compile time goes into headers and templates that many sources share. Compiled in groups,
# they are parsed and instantiated once per group. `./run` builds in this way; for work on single sources it is not
# needed.
option(UNDERSTUDY_GROUPS "Compile sources in groups: less work from nothing, more after a change" OFF)

# compile_in_groups(TARGET [SIZE NUMBER] [APART SOURCE...]): compiles in groups of NUMBER sources; the larger a group,
# the more likely two sources define the same local name. APART lists sources whose local names collide with another
# source of the group, and sources that are compiled once per instruction set.
function(compile_in_groups target)
  cmake_parse_arguments(ARG "" "SIZE" "APART" ${ARGN})
  if(NOT UNDERSTUDY_GROUPS)
    return()
  endif()
  if(NOT ARG_SIZE)
    set(ARG_SIZE 40)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${ARG_SIZE})
  # gcc treats included sources as headers, whose unnamed namespaces would differ in every user.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  set_source_files_properties(${ARG_APART} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
