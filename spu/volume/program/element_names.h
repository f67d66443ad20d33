// SPDX-License-Identifier: Apache-2.0
// Names of variables, as spelled by the analysis and by queries of OpenGL.
#pragma once

#include <string_view>

namespace understudy::spu::program {

/// Returns the name of the array that an element belongs to.
inline std::string_view variable_of(std::string_view name) {
  return name.substr(0, name.find('['));
}

/// Returns whether both may name the same element: queries append "[0]" to arrays, or name an array as a whole,
/// and the analysis writes "[*]" if it does not distinguish elements.
bool may_be_same_element(std::string_view a, std::string_view b);

}  // namespace understudy::spu::program
