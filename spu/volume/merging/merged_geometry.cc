// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/merged_geometry.h"

#include <algorithm>

namespace understudy::spu {
namespace {

/// Transforms a half-space from a brick's texture space to the volume's.
volume::HalfSpace carried(const volume::HalfSpace& plane, const PlaceMap& map) {
  volume::HalfSpace moved{{}, plane.offset};
  for (std::size_t k = 0; k < 3; ++k) {
    moved.normal[k] = plane.normal[k] / map.scale[k];
    moved.offset -= moved.normal[k] * map.offset[k];
  }
  return moved;
}

/// Polygons of all bricks in the volume's texture space, sorted by the position of their planes along `axis`.
class AllPolygons {
 public:
  void add(const ObservedPolygons& polygons, const PlaceMap& map, const volume::Vec3& axis) {
    clipped_ = clipped_ || polygons.clipped;
    for (std::size_t p = 0; p < polygons.count(); ++p) {
      Polygon polygon{vertices_.size(), 0, 0};
      for (ObservedVertex vertex : polygons.polygon(p)) {
        vertex.texture = map(vertex.texture);
        for (std::size_t k = 0; k < 3; ++k) polygon.place += axis[k] * vertex.texture[k];
        vertices_.push_back(vertex);
      }
      polygon.count = vertices_.size() - polygon.first;
      if (polygon.count == 0) continue;
      polygon.place /= double(polygon.count);
      polygons_.push_back(polygon);
    }
  }

  ObservedPolygons sorted() {
    std::sort(polygons_.begin(), polygons_.end(),
              [](const Polygon& a, const Polygon& b) { return a.place < b.place; });
    ObservedPolygons all;
    all.clipped = clipped_;
    all.vertices.reserve(vertices_.size());
    for (const Polygon& polygon : polygons_) {
      const auto first = vertices_.begin() + std::ptrdiff_t(polygon.first);
      all.vertices.insert(all.vertices.end(), first, first + std::ptrdiff_t(polygon.count));
      all.first.push_back(all.vertices.size());
    }
    return all;
  }

 private:
  struct Polygon {
    std::size_t first;
    std::size_t count;
    double place;
  };
  std::vector<ObservedVertex> vertices_;
  std::vector<Polygon> polygons_;
  bool clipped_ = false;
};

}  // namespace

volume::RenderRequest placed_as_whole(const MergedVolume& merged, GLuint texture,
                                      volume::RenderRequest request) {
  const std::size_t place = *merged.place_of(texture);
  const PlaceMap map = map_of(merged.tiling, place, merged.descriptions[place].size);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t k = 0; k < 3; ++k) {
      double& scaled = request.texture_to_clip[4 * row + k];
      scaled /= map.scale[k];
      request.texture_to_clip[4 * row + 3] -= scaled * map.offset[k];
    }
  }
  request.region = {};
  request.clip_planes.clear();
  return request;
}

MergedSlices merged_slices(const MergedVolume& merged, std::span<const BrickSlices> bricks,
                           const Pipeline& pipeline) {
  const RecognisedRun& first = *bricks.front().seen;
  std::vector<PlaceMap> maps;
  for (const BrickSlices& brick : bricks) {
    const std::size_t place = *merged.place_of(brick.texture);
    maps.push_back(map_of(merged.tiling, place, merged.descriptions[place].size));
  }
  const SliceOrder order = order_of(pipeline);
  // The direction in which the planes are drawn through the whole volume, towards the eye or from it.
  const double sign = (order == SliceOrder::front_to_back ? 1 : -1) * first.slices.planes.spacing;
  volume::Vec3 axis{};
  for (std::size_t k = 0; k < 3; ++k) axis[k] = sign * first.slices.planes.normal[k] / maps.front().scale[k];

  AllPolygons all;
  std::vector<volume::Box> regions;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    all.add(bricks[i].seen->polygons, maps[i], axis);
    const volume::Box& region = bricks[i].seen->slices.region;
    regions.push_back({maps[i](region.low), maps[i](region.high)});
  }
  const ObservedPolygons polygons = all.sorted();
  const auto camera = fit_camera(polygons.vertices);
  if (!camera || camera->residual > max_fit_residual) throw Refusal{"the bricks have no camera in common"};
  MergedSlices whole{*camera, {}, first.clip_planes};
  for (volume::HalfSpace& plane : whole.clip_planes) plane = carried(plane, maps.front());
  SliceFinding finding = find_slices(polygons, whole.camera, whole.clip_planes, order);
  if (const auto* refusal = std::get_if<Refusal>(&finding))
    throw Refusal{"of the bricks together, " + refusal->reason};
  whole.slices = std::get<SliceSet>(finding);
  if (order != SliceOrder::any && !drawn_in_order(regions, whole.camera.texture_to_clip, whole.slices.planes,
                                                  order == SliceOrder::back_to_front))
    throw Refusal{"the bricks are not drawn in the order in which they lie"};
  return whole;
}

}  // namespace understudy::spu
