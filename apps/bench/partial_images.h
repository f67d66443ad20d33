// SPDX-License-Identifier: Apache-2.0
// The partial images that the ranks of a node group hold before an exchange: rendered by the ray caster from
// each rank's box of one volume, or noise.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "volume/image.h"

namespace understudy::bench {

/// Full: the boxes lie one behind the other, and each rank's image covers the whole image and touches every
/// pixel. Sparse: the boxes of the kd-tree, with the eye outside; most of the volume is clear. Noise: as full,
/// but of independent random numbers.
enum class Scene { full, sparse, noise };
inline constexpr std::array all_scenes{Scene::full, Scene::sparse, Scene::noise};
std::string_view name_of(Scene scene);

struct PartialImage {
  volume::Image image;     ///< of this rank, cropped to its content
  std::vector<int> order;  ///< all ranks, front first
};

/// Makes this rank's image of `pixels` x `pixels`, for `over`. `texels` are bytes, `side`
/// along each axis, x fastest.
PartialImage partial_image(Scene scene, int pixels, std::span<const std::byte> texels, int side, int rank,
                           int ranks);

}  // namespace understudy::bench
