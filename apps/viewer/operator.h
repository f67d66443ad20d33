// SPDX-License-Identifier: Apache-2.0
// How slices are blended in the framebuffer.
//
//   over   back to front, SRC_ALPHA, 1 - SRC_ALPHA
//   under  front to back, 1 - DST_ALPHA, ONE: premultiplied colours, and a framebuffer with alpha; solid
//          geometry and background come last
//   max    the greatest value along the line of sight, in grey (GL_MAX)
//   min    the least value (GL_MIN)
//   add    the sum, SRC_ALPHA, ONE
#pragma once

#include <optional>
#include <string_view>

#include "apps/viewer/model/transfer_function.h"

namespace viewer {

enum class Operator { over, under, max, min, add };

std::string_view name_of(Operator op);
std::optional<Operator> operator_named(std::string_view name);

/// OpenGL's names of the state that blend_with() sets.
struct BlendNames {
  std::string_view source, destination, equation;
};
BlendNames blend_names(Operator op);

/// Enables blending with the operator.
void blend_with(Operator op);

/// Converts the colours for the operator: premultiplied for under, the values in grey for max and min.
Table colours_for(Operator op, const Table& table);

}  // namespace viewer
