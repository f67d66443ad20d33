# SPDX-License-Identifier: Apache-2.0
# Headers of the standard library and of other projects are parsed once for each library, not once for each file: that
# is most of what compiling takes. Every file still includes what it needs; clang-tidy reads them without this.

# What almost every file includes, directly or not.
set(standard_headers
  <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map>
  <memory> <mutex> <optional> <set> <span> <sstream> <stdexcept> <string> <string_view> <thread> <unordered_map>
  <utility> <variant> <vector>)

# ccache asks for this, to find in its preprocessed text which precompiled header was used.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
endif()

# precompile_headers(TARGET [HEADER…]): with the standard headers, these, which TARGET's own libraries provide.
function(precompile_headers target)
  target_precompile_headers(${target} PRIVATE ${standard_headers} ${ARGN})
endfunction()
