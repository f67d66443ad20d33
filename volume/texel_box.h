// SPDX-License-Identifier: Apache-2.0
// Boxes of texels. Their texels are tightly packed, x fastest.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace understudy::volume {

/// Half-open box of texels or cells.
struct TexelBox {
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  bool operator==(const TexelBox&) const = default;
};

/// Whether the box contains no texel: on some axis `high` is not above `low`.
bool is_empty(const TexelBox& box);
/// Whether `inner` lies inside `outer`.
bool contains(const TexelBox& outer, const TexelBox& inner);
/// May be empty.
TexelBox intersection(const TexelBox& a, const TexelBox& b);
/// The smallest box that contains both; an empty one adds nothing.
TexelBox enclosing(const TexelBox& a, const TexelBox& b);
/// Number of texels; 0 for empty boxes.
std::size_t texels_in(const TexelBox& box);

/// Copies the texels of `box`, which must lie in both `source_box` and `target_box`.
void copy_texels(const TexelBox& box, std::size_t bytes_per_texel, const TexelBox& source_box,
                 std::span<const std::byte> source, const TexelBox& target_box, std::span<std::byte> target);

}  // namespace understudy::volume
