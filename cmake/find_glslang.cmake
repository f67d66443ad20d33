# SPDX-License-Identifier: Apache-2.0
# glslang, the front end of GLSL, with the headers of its syntax tree. Distributions install these up to glslang 13; where
# they do not, the version that is tested is built here: fetched, or taken from -DFETCHCONTENT_SOURCE_DIR_GLSLANG=FOLDER.
find_package(glslang QUIET)
if(glslang_FOUND)
  get_target_property(glslang_includes glslang::glslang INTERFACE_INCLUDE_DIRECTORIES)
  find_file(GLSLANG_TREE_HEADER glslang/Include/intermediate.h PATHS ${glslang_includes})
endif()
if(GLSLANG_TREE_HEADER)
  # A distribution's is built with its HLSL parts; its headers must be read alike.
  set(understudy_glslang glslang::glslang glslang::glslang-default-resource-limits)
  set(understudy_glslang_definitions ENABLE_HLSL)
  return()
endif()

message(STATUS "This glslang has no headers of its syntax tree: building one")
include(FetchContent)
FetchContent_Declare(glslang GIT_REPOSITORY https://github.com/KhronosGroup/glslang.git GIT_TAG 12.0.0 GIT_SHALLOW ON)
foreach(part ENABLE_GLSLANG_BINARIES ENABLE_SPVREMAPPER ENABLE_CTEST ENABLE_OPT ENABLE_HLSL BUILD_EXTERNAL ENABLE_PCH)
  set(${part} OFF CACHE INTERNAL "of glslang")
endforeach()
set(SKIP_GLSLANG_INSTALL ON CACHE INTERNAL "of glslang")
FetchContent_GetProperties(glslang)
if(NOT glslang_POPULATED)
  FetchContent_Populate(glslang)
  # Its own warnings are its own.
  add_subdirectory(${glslang_SOURCE_DIR} ${glslang_BINARY_DIR} EXCLUDE_FROM_ALL SYSTEM)
endif()
set(understudy_glslang glslang glslang-default-resource-limits)
set(understudy_glslang_definitions "")
