// SPDX-License-Identifier: Apache-2.0
// Transfer functions: colour and opacity by voxel value.
//
// A preset is a piecewise linear function of the texel value in [0,1]. Its opacity is per reference
// distance, which is the finest voxel edge. For slices at another spacing it is corrected: a' = 1 - (1 -
// a)^(spacing / reference). Colours are not premultiplied, and continue where the opacity is 0, so that
// interpolation produces no dark rim.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace viewer {

struct ControlPoint {
  double value;  ///< texel value in [0,1], ascending; two points at one value make a step
  double red, green, blue;
  double opacity;  ///< per reference distance, 0 to 1
};

struct Preset {
  std::string_view name;
  std::string_view meaning;
  std::span<const ControlPoint> points;
};

/// Presets in the order of the keys 1, 2, ...
std::span<const Preset> presets();

/// Finds a preset by name or number ("1" is the first); nullptr if there is none.
const Preset* find_preset(std::string_view name_or_number);

using Rgba8 = std::array<std::uint8_t, 4>;

/// Entry i is the colour of texel value i/255; values between two entries are interpolated linearly.
using Table = std::array<Rgba8, 256>;

/// Returns the preset with the opacity correction applied, in 8 bits as passed to OpenGL.
/// `exponent` is slice spacing / reference distance. `zero_is_empty`: value 0 represents "no
/// value" and is transparent.
Table make_table(const Preset& preset, double exponent, bool zero_is_empty);

/// Returns the table at texel value `value` in [0,1], interpolated linearly and rounded.
Rgba8 look_up(const Table& table, double value);

}  // namespace viewer
