// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/merged_volume.h"

#include <algorithm>

namespace understudy::spu {
namespace {

bool alike(const Target& a, const Target& b) {
  return a.alpha_bits == b.alpha_bits && a.normalised == b.normalised && a.floating == b.floating &&
         a.samples == b.samples;
}

}  // namespace

bool alike(const TextureDescription& a, const TextureDescription& b) {
  return a.type == b.type && a.base == b.base && a.opaque == b.opaque && a.grey == b.grey &&
         a.filter == b.filter && a.wrap == b.wrap && a.border == b.border && a.swizzle == b.swizzle;
}

bool alike(const Pipeline& a, const volume::RenderRequest& first, const Pipeline& b,
           const volume::RenderRequest& second) {
  return a.blending == b.blending && alike(a.target, b.target) && a.depth_test == b.depth_test &&
         a.depth_or_equal == b.depth_or_equal && first.viewport == second.viewport &&
         first.window == second.window && first.depth_range == second.depth_range && first.op == second.op &&
         first.clip_planes.size() == second.clip_planes.size() && first.classification == second.classification;
}

std::optional<std::size_t> MergedVolume::place_of(GLuint texture) const {
  const auto found = std::find(textures.begin(), textures.end(), texture);
  if (found == textures.end()) return std::nullopt;
  return std::size_t(found - textures.begin());
}

}  // namespace understudy::spu
