// SPDX-License-Identifier: Apache-2.0
// The values over which a table is measured: 4,081 entries are few for 65,536 values, of which a scanner uses a
// few thousand.
#pragma once

#include <array>

#include "volume/texel_type.h"

namespace understudy::spu {

struct TextureDescription;

/// Entries of a measured table. Over all of 8 bits, multiples of 1/255 fall on entries, so that 8-bit tables
/// keep their steps.
constexpr int probed_entries = 16 * 255 + 1;

/// Whether a table is spread over the values that the texels have, and not over all that their type can have.
constexpr bool has_value_range(volume::TexelType type) {
  return type == volume::TexelType::f32 || type == volume::TexelType::u16;
}

/// Lowest and highest value of the table: for such a type those of the texels, whose finite ones lie in
/// `texels`, with the border colour where it shows; [0,1] for others. Of normalised texels it is rounded
/// outwards so that every value they can have falls on an entry (up to 4,081 values; of more, every second,
/// third
/// ...), and so that a field that changes a little keeps its table.
std::array<float, 2> value_range(const TextureDescription& description, std::array<float, 2> texels);

}  // namespace understudy::spu
