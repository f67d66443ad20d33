// SPDX-License-Identifier: Apache-2.0
// Names of variables, as the analysis and as queries of OpenGL spell them.
#pragma once

#include <string_view>

namespace understudy::spu::program {

/// Whether both may name the same element: queries add "[0]" to arrays, or name an array as a whole, and the
/// analysis writes "[*]" where it keeps elements together.
bool may_be_same_element(std::string_view a, std::string_view b);

}  // namespace understudy::spu::program
