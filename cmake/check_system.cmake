# SPDX-License-Identifier: Apache-2.0
# Checks the requirements on system and compiler; otherwise the build would fail later with uninformative errors.
include(CheckCXXSourceCompiles)
if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
  message(FATAL_ERROR "Understudy is built for Linux, not for ${CMAKE_SYSTEM_NAME}: it stands between a program and Linux's loader")
endif()
if(NOT CMAKE_SIZEOF_VOID_P EQUAL 8)
  message(FATAL_ERROR "Understudy is built for 64 bits: volumes are larger than 32 bits address")
endif()
foreach(oldest "GNU 12" "Clang 14")
  string(REPLACE " " ";" oldest ${oldest})
  list(GET oldest 0 compiler)
  list(GET oldest 1 version)
  if(CMAKE_CXX_COMPILER_ID STREQUAL compiler AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS version)
    message(FATAL_ERROR "${compiler} ${CMAKE_CXX_COMPILER_VERSION} does not compile C++20 as far as Understudy uses it: "
      "choose version ${version} or later with -DCMAKE_CXX_COMPILER=PROGRAM")
  endif()
endforeach()

# understudy_requires(RESULT MACRO SENTENCE...): MACRO must be defined by the standard library's headers.
function(understudy_requires result macro)
  check_cxx_source_compiles("#include <cstdlib>\n#ifndef ${macro}\n#error\n#endif\nint main() {}" ${result})
  if(NOT ${result})
    unset(${result} CACHE)
    string(CONCAT sentence ${ARGN})
    message(FATAL_ERROR ${sentence})
  endif()
endfunction()
understudy_requires(UNDERSTUDY_HAS_GLIBC __GLIBC__ "Understudy needs glibc: its libraries get under a viewer by LD_AUDIT, which "
  "musl's loader does not have")
understudy_requires(UNDERSTUDY_HAS_LIBSTDCXX __GLIBCXX__ "Understudy needs libstdc++: the C++ libraries of distributions that it "
  "links are built with it. Leave -stdlib=libc++ out")
