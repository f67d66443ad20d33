// SPDX-License-Identifier: Apache-2.0
#include "volume/texel_box.h"

#include <algorithm>
#include <cstring>

#include "volume/texel_type.h"

namespace understudy::volume {

namespace {

std::size_t texels_along(const TexelBox& box, std::size_t axis) {
  return std::size_t(box.high[axis] - box.low[axis]);
}

/// Index of a texel within `box`.
std::size_t place(const TexelBox& box, int x, int y, int z) {
  return (std::size_t(z - box.low[2]) * texels_along(box, 1) + std::size_t(y - box.low[1])) *
             texels_along(box, 0) +
         std::size_t(x - box.low[0]);
}

}  // namespace

bool is_empty(const TexelBox& box) {
  return box.low[0] >= box.high[0] || box.low[1] >= box.high[1] || box.low[2] >= box.high[2];
}

bool contains(const TexelBox& outer, const TexelBox& inner) {
  for (std::size_t k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k]) return false;
  return true;
}

TexelBox intersection(const TexelBox& a, const TexelBox& b) {
  TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::max(a.low[k], b.low[k]);
    box.high[k] = std::min(a.high[k], b.high[k]);
  }
  return box;
}

TexelBox enclosing(const TexelBox& a, const TexelBox& b) {
  if (is_empty(a)) return b;
  if (is_empty(b)) return a;
  TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::min(a.low[k], b.low[k]);
    box.high[k] = std::max(a.high[k], b.high[k]);
  }
  return box;
}

std::size_t texels_in(const TexelBox& box) {
  return is_empty(box) ? 0 : texels_along(box, 0) * texels_along(box, 1) * texels_along(box, 2);
}

void copy_texels(const TexelBox& box, std::size_t bytes_per_texel, const TexelBox& source_box,
                 std::span<const std::byte> source, const TexelBox& target_box, std::span<std::byte> target) {
  if (is_empty(box)) return;
  const std::size_t row = texels_along(box, 0) * bytes_per_texel;
  for (int z = box.low[2]; z < box.high[2]; ++z)
    for (int y = box.low[1]; y < box.high[1]; ++y)
      std::memcpy(target.data() + place(target_box, box.low[0], y, z) * bytes_per_texel,
                  source.data() + place(source_box, box.low[0], y, z) * bytes_per_texel, row);
}

}  // namespace understudy::volume
