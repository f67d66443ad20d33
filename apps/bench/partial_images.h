// SPDX-License-Identifier: Apache-2.0
// What the ranks of a node group hold before an exchange: partial images of one volume, rendered by the rank's
// own ray caster from its own box, or noise.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "volume/image.h"

namespace understudy::bench {

/// Full: boxes behind each other, and every rank's image covers the whole image with no pixel untouched.
/// Sparse: the boxes of the kd-tree from an eye outside, most of the volume clear. Noise: as full, of
/// independent random numbers.
enum class Scene { full, sparse, noise };
inline constexpr std::array all_scenes{Scene::full, Scene::sparse, Scene::noise};
std::string_view name_of(Scene scene);

struct PartialImage {
  volume::Image image;     ///< of this rank, cropped to what shows
  std::vector<int> order;  ///< all ranks, front first
};

/// An image of `pixels` x `pixels` under `over`. `texels` are bytes, `side` along each axis, x fastest.
PartialImage partial_image(Scene scene, int pixels, std::span<const std::byte> texels, int side, int rank,
                           int ranks);

}  // namespace understudy::bench
