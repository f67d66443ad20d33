// SPDX-License-Identifier: Apache-2.0
// Names of variables, as the analysis and as queries of OpenGL spell them.
#pragma once

#include <string_view>

namespace understudy::spu::program {

/// Of an element of an array, the array.
inline std::string_view variable_of(std::string_view name) {
  return name.substr(0, name.find('['));
}

/// Whether both may name the same element: queries add "[0]" to arrays, or name an array as a whole, and the
/// analysis writes "[*]" where it keeps elements together.
bool may_be_same_element(std::string_view a, std::string_view b);

}  // namespace understudy::spu::program
