// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/tiling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volume/cell_lattice.h"
#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::Matrix4;
using volume::TexelBox;

/// Tolerated offset of texels from their lattice: rounding leaves far less, and half a texel is another
/// lattice.
constexpr double same_texel = 0.05;
/// Coordinates this close, in texels, are equal.
constexpr double same_brick_place = 0.01;
/// This fraction of the box around all regions must be filled; the rest may be gaps as wide as the distance of
/// slices. Whether the slices really fill a box is checked later.
constexpr double least_filled = 0.5;

/// Returns the region in texels of the texture.
volume::Box in_texels(const DrawnBrick& brick) {
  volume::Box box = brick.region;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] *= brick.size[k];
    box.high[k] *= brick.size[k];
  }
  return box;
}

double volume_of(const volume::Box& box) {
  return (box.high[0] - box.low[0]) * (box.high[1] - box.low[1]) * (box.high[2] - box.low[2]);
}

bool overlap(const volume::Box& a, const volume::Box& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::min(a.high[k], b.high[k]) - std::max(a.low[k], b.low[k]) < same_brick_place) return false;
  }
  return true;
}

/// The largest brick determines the positions of the others most precisely.
const DrawnBrick& largest_of(std::span<const DrawnBrick> bricks) {
  return *std::max_element(bricks.begin(), bricks.end(), [](const DrawnBrick& a, const DrawnBrick& b) {
    return std::int64_t(a.size[0]) * a.size[1] * a.size[2] < std::int64_t(b.size[0]) * b.size[1] * b.size[2];
  });
}

}  // namespace

TexelBox texels_read(const volume::Box& region, const std::array<int, 3>& size, volume::Filter filter) {
  const double reach = filter == volume::Filter::linear ? 0.5 : 0;
  TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = size[k];
    box.low[k] = int(std::floor(std::clamp(region.low[k] * n - reach + same_brick_place, 0.0, n - 1)));
    box.high[k] =
        int(std::ceil(std::clamp(region.high[k] * n + reach - same_brick_place, box.low[k] + 1.0, n)));
  }
  return box;
}

std::optional<std::array<int, 3>> lattice_offset(const DrawnBrick& base, const DrawnBrick& brick) {
  const auto clip_to_base = volume::inverse(base.texture_to_clip);
  if (!clip_to_base) return std::nullopt;
  Matrix4 map = volume::multiply(*clip_to_base, brick.texture_to_clip);
  if (!(std::abs(map[15]) > 0)) return std::nullopt;
  const double w = map[15];
  for (double& m : map) m /= w;
  std::array<int, 3> offset{};
  double projective = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    // The brick's edges, in texels of the base.
    const double n = base.size[row];
    for (std::size_t column = 0; column < 3; ++column) {
      const double moved = map[4 * row + column] * n;
      const double wanted = row == column ? brick.size[column] : 0;
      if (!(std::abs(moved - wanted) < same_texel)) return std::nullopt;
    }
    const double place = map[4 * row + 3] * n;
    if (!(std::abs(place) < volume::max_axis_texels) || std::abs(place - std::round(place)) >= same_texel)
      return std::nullopt;
    offset[row] = int(std::lround(place));
    projective += std::abs(map[12 + row]) * (std::abs(place) + brick.size[row]);
  }
  if (projective >= same_texel) return std::nullopt;
  return offset;
}

std::variant<Tiling, std::string> find_tiling(std::span<const DrawnBrick> bricks, volume::Filter filter,
                                              const std::array<volume::Wrap, 3>& wrap) {
  if (bricks.size() < 2) return "one texture is no tiling";
  const DrawnBrick& base = largest_of(bricks);
  Tiling tiling;
  std::vector<volume::Box> regions;
  constexpr double far = std::numeric_limits<double>::max();
  volume::Box around{{far, far, far}, {-far, -far, -far}};
  TexelBox all;
  double filled = 0;
  for (const DrawnBrick& brick : bricks) {
    const auto origin = lattice_offset(base, brick);
    if (!origin) return "the textures' texels are not of one lattice";
    Tiling::Place place{*origin, brick.shown};
    volume::Box region = in_texels(brick);
    for (std::size_t k = 0; k < 3; ++k) {
      place.texels.low[k] += place.origin[k];
      place.texels.high[k] += place.origin[k];
      region.low[k] += place.origin[k];
      region.high[k] += place.origin[k];
      around.low[k] = std::min(around.low[k], region.low[k]);
      around.high[k] = std::max(around.high[k], region.high[k]);
    }
    for (const volume::Box& other : regions) {
      if (overlap(other, region)) return "the textures overlap";
    }
    all = volume::enclosing(all, place.texels);
    filled += volume_of(region);
    regions.push_back(region);
    tiling.places.push_back(place);
  }
  if (filled < least_filled * volume_of(around)) return "the textures do not fill a box";

  const double reach = filter == volume::Filter::linear ? 0.5 : 0;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int first = tiling.places[i].origin[k];
      const int end = first + bricks[i].size[k];
      const bool beyond_low = regions[i].low[k] - reach < first - same_brick_place;
      const bool beyond_high = regions[i].high[k] + reach > end + same_brick_place;
      if ((beyond_low || beyond_high) && wrap[k] == volume::Wrap::repeat) return "a brick's texture repeats";
      if ((beyond_low && first != all.low[k]) || (beyond_high && end != all.high[k]))
        return "a brick's faces show: it does not hold its neighbour's texels";
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    tiling.size[k] = all.high[k] - all.low[k];
    if (tiling.size[k] > volume::max_axis_texels) return "the volume is too large";
    for (Tiling::Place& place : tiling.places) {
      place.origin[k] -= all.low[k];
      place.texels.low[k] -= all.low[k];
      place.texels.high[k] -= all.low[k];
    }
  }
  return tiling;
}

PlaceMap map_of(const Tiling& tiling, std::size_t brick, const std::array<int, 3>& size) {
  PlaceMap map;
  for (std::size_t k = 0; k < 3; ++k) {
    map.scale[k] = double(size[k]) / tiling.size[k];
    map.offset[k] = double(tiling.places[brick].origin[k]) / tiling.size[k];
  }
  return map;
}

bool drawn_in_order(std::span<const volume::Box> regions, const Matrix4& texture_to_clip,
                    const volume::SlicePlanes& planes, bool back_to_front) {
  const auto clip_to_texture = volume::inverse(texture_to_clip);
  if (!clip_to_texture) return false;
  // All rays meet at this point, or are parallel to it if the last component is 0.
  const volume::Vec4 eye = volume::transform(*clip_to_texture, {0, 0, 1, 0});
  const auto direction = [&](std::size_t axis, double plane) { return eye[axis] - plane * eye[3]; };
  // Planes are numbered from the eye: this decides whether rays run along `direction` or against it.
  volume::Vec3 middle{};
  for (const volume::Box& region : regions) {
    for (std::size_t k = 0; k < 3; ++k)
      middle[k] += (region.low[k] + region.high[k]) / (2 * double(regions.size()));
  }
  double along = 0;
  for (std::size_t k = 0; k < 3; ++k) along += planes.spacing * planes.normal[k] * direction(k, middle[k]);
  const double sign = (along >= 0) == back_to_front ? 1 : -1;

  constexpr double touching = 1e-4;
  for (std::size_t later = 1; later < regions.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const volume::Box &a = regions[earlier], &b = regions[later];
      // If drawn back to front: may a ray meet the earlier brick first, and then the later one?
      bool separated = false;
      bool possible = true;
      for (std::size_t k = 0; k < 3 && possible; ++k) {
        if (a.high[k] <= b.low[k] + touching) {
          separated = true;
          possible = sign * direction(k, (a.high[k] + b.low[k]) / 2) > 0;
        } else if (b.high[k] <= a.low[k] + touching) {
          separated = true;
          possible = sign * direction(k, (b.high[k] + a.low[k]) / 2) < 0;
        }
      }
      if (!separated || possible) return false;
    }
  }
  return true;
}

}  // namespace understudy::spu
