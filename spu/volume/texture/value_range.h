// SPDX-License-Identifier: Apache-2.0
// The values over which a table is measured: 4,081 entries are few for 65,536 values, of which a scanner uses a
// few thousand.
#pragma once

#include <array>

#include "volume/texel_type.h"

namespace understudy::spu {

struct TextureDescription;

/// Entries of a measured table, except under the nearest filter (table_entries). Over all 8-bit values,
/// multiples of 1/255 fall on entries, so that 8-bit tables keep their steps.
constexpr int probed_entries = 16 * 255 + 1;

/// Entries of the table of a ray caster: multiples of 1/255 fall on entries.
constexpr int probed_entries_of_rays = 4 * 255 + 1;

/// Returns whether a table covers the values that the texels have, instead of all that their type can have.
constexpr bool has_value_range(volume::TexelType type) {
  return type == volume::TexelType::f32 || type == volume::TexelType::u16;
}

/// Returns the lowest and highest value of the table: for such a type those of the texels, whose finite values
/// lie in `texels`, and of the border colour if it is visible; [0,1] for others. For normalised texels they are
/// rounded outwards so that every value that texels can have falls on an entry (up to 4,081 values; of more,
/// every second, third, ...), and so that a field that changes a little keeps its table.
std::array<float, 2> value_range(const TextureDescription& description, std::array<float, 2> texels);

/// Returns the number of entries of a table over `range`. Under the nearest filter, samples are texels, and
/// each may be a label with a colour of its own: the table has all values that normalised texels can have, up
/// to 65,536.
int table_entries(const TextureDescription& description, const std::array<float, 2>& range);

/// Returns whether texels may have values between the `entries` entries of a table over `range`, with colours
/// of their own: samples by the nearest filter then show what no entry holds.
bool may_lie_between_entries(const TextureDescription& description, const std::array<float, 2>& range,
                             int entries);

}  // namespace understudy::spu
