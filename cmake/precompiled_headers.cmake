# SPDX-License-Identifier: Apache-2.0
# Headers of the standard library and of other projects take most of the compile time, so they are parsed once per
# library instead of once per file. Every file still includes what it needs; clang-tidy runs without precompiled
# headers.

# Included by almost every file, directly or indirectly.
set(standard_headers
  <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map>
  <memory> <mutex> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <thread> <unordered_map>
  <utility> <variant> <vector>)

# Required by ccache, which finds in the preprocessed text which precompiled header was used.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
endif()

# precompile_headers(TARGET [HEADER...]): precompiles the standard headers and these, which TARGET's own libraries
# provide.
function(precompile_headers target)
  target_precompile_headers(${target} PRIVATE ${standard_headers} ${ARGN})
endfunction()
