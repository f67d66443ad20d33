// SPDX-License-Identifier: Apache-2.0
// Whether several textures are pieces of one volume: from the cameras they are drawn under follows where each
// lies among the texels of the others.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "volume/sampling.h"
#include "volume/texel_box.h"
#include "volume/texture_filter.h"

namespace understudy::spu {

/// One texture as it was drawn.
struct DrawnBrick {
  std::array<int, 3> size{};  ///< in texels
  volume::Matrix4 texture_to_clip{};
  volume::Box region;      ///< of its texture space that its slices fill
  volume::TexelBox shown;  ///< the texels that samples of this or an earlier region read
};

/// Texels of a texture of `size` that samples of `region` read; the filter's neighbours without weight left
/// out.
volume::TexelBox texels_read(const volume::Box& region, const std::array<int, 3>& size, volume::Filter filter);

/// Where texel (0,0,0) of `brick` lies among the texels of `base`, in texels; null where the texels of both are
/// not of one lattice (turned, of another size, shifted by a part of a texel).
std::optional<std::array<int, 3>> lattice_offset(const DrawnBrick& base, const DrawnBrick& brick);

struct Tiling {
  struct Place {
    std::array<int, 3> origin{};  ///< of the texture's texel (0,0,0) among the volume's; may lie outside
    volume::TexelBox texels;      ///< of the volume, which the texture holds
  };
  std::array<int, 3> size{};  ///< of the volume, in texels
  std::vector<Place> places;  ///< of the bricks, in their order
};

/// Either the places of all bricks in one volume, or why they are none. Samples near a brick's face must find
/// the neighbour's texels in the brick itself: where they do not, the faces are to be seen in the application's
/// own image, and one volume would not show them. Only the outer faces may be the texture's ends.
std::variant<Tiling, std::string> find_tiling(std::span<const DrawnBrick> bricks, volume::Filter filter,
                                              const std::array<volume::Wrap, 3>& wrap);

/// A texture coordinate of the brick as one of the volume, scale and offset along each axis.
struct PlaceMap {
  volume::Vec3 scale{};
  volume::Vec3 offset{};

  volume::Vec3 operator()(const volume::Vec3& t) const {
    return {scale[0] * t[0] + offset[0], scale[1] * t[1] + offset[1], scale[2] * t[2] + offset[2]};
  }
};
PlaceMap map_of(const Tiling& tiling, std::size_t brick, const std::array<int, 3>& size);

/// Whether bricks that fill `regions` of texture space, drawn in this order, are never drawn over by one that
/// lies behind them: back to front, or, the other way round, front to back.
bool drawn_in_order(std::span<const volume::Box> regions, const volume::Matrix4& texture_to_clip,
                    const volume::SlicePlanes& planes, bool back_to_front);

}  // namespace understudy::spu
