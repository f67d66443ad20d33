// SPDX-License-Identifier: Apache-2.0
// Determines whether several textures are bricks of one volume: the cameras with which they are drawn determine
// where each lies among the texels of the others.
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
  volume::Box region;      ///< of its texture space, filled by its slices
  volume::TexelBox shown;  ///< texels read by samples in this region or an earlier one
};

/// Returns the texels of a texture of `size` that samples in `region` read, without the filter's neighbours of
/// weight zero.
volume::TexelBox texels_read(const volume::Box& region, const std::array<int, 3>& size, volume::Filter filter);

/// Returns the position of texel (0,0,0) of `brick` among the texels of `base`, in texels; null if both are not
/// on one lattice (rotated, of another size, shifted by a fraction of a texel).
std::optional<std::array<int, 3>> lattice_offset(const DrawnBrick& base, const DrawnBrick& brick);

struct Tiling {
  struct Place {
    std::array<int, 3> origin{};  ///< position of the texture's texel (0,0,0) among the volume's; may lie
                                  ///< outside
    volume::TexelBox texels;      ///< texels of the volume that the texture holds
  };
  std::array<int, 3> size{};  ///< of the volume, in texels
  std::vector<Place> places;  ///< of the bricks, in their order
};

/// Returns the places of all bricks in one volume, or the reason why there are none. Samples near a brick's
/// face must find the neighbour's texels in the brick itself; otherwise the faces are visible in the
/// application's own image, and one volume would not show them. Only outer faces may be the ends of a texture.
std::variant<Tiling, std::string> find_tiling(std::span<const DrawnBrick> bricks, volume::Filter filter,
                                              const std::array<volume::Wrap, 3>& wrap);

/// Maps a texture coordinate of the brick to one of the volume: scale and offset along each axis.
struct PlaceMap {
  volume::Vec3 scale{};
  volume::Vec3 offset{};

  volume::Vec3 operator()(const volume::Vec3& t) const {
    return {scale[0] * t[0] + offset[0], scale[1] * t[1] + offset[1], scale[2] * t[2] + offset[2]};
  }
};
PlaceMap map_of(const Tiling& tiling, std::size_t brick, const std::array<int, 3>& size);

/// Returns whether bricks that fill `regions` of texture space are drawn in visibility order, back to front or
/// front to back: none is drawn over by one that lies behind it, or vice versa.
bool drawn_in_order(std::span<const volume::Box> regions, const volume::Matrix4& texture_to_clip,
                    const volume::SlicePlanes& planes, bool back_to_front);

}  // namespace understudy::spu
