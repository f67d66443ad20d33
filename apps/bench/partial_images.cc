// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/partial_images.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "compositor/crop.h"
#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/kd_tree.h"
#include "volume/matrix.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::bench {

namespace {

using namespace volume;

/// Dense: every value is slightly opaque. Sparse: only the higher values are.
TransferFunction transfer_function(Scene scene) {
  constexpr int first_visible = 100;
  TransferFunction function;
  for (int i = 0; i < 256; ++i) {
    const double dense = 0.002 + 0.02 * i / 255;
    const double sparse = i < first_visible ? 0 : 0.01 + 0.1 * (i - first_visible) / 155.0;
    const double alpha = scene == Scene::sparse ? sparse : dense;
    function.entries.push_back({float(alpha * (0.3 + 0.7 * i / 255)),
                                float(alpha * (0.5 + 0.5 * std::sin(i * 0.05))),
                                float(alpha * (1 - 0.8 * i / 255)), float(alpha)});
  }
  return function;
}

/// View along z; the volume is slightly larger than the image.
Matrix4 parallel_view() {
  const double zoom = 2.04;
  return {zoom, 0, 0, -zoom / 2, 0, zoom, 0, -zoom / 2, 0, 0, 2, -1, 0, 0, 0, 1};
}

/// The eye is two edges away, at azimuth 30 and elevation 25 degrees; the field of view is 40 degrees.
Matrix4 perspective_view() {
  constexpr double degree = std::numbers::pi / 180;
  const Vec3 back{std::sin(30 * degree) * std::cos(25 * degree), std::sin(25 * degree),
                  std::cos(30 * degree) * std::cos(25 * degree)};
  const Vec3 right{std::cos(30 * degree), 0, -std::sin(30 * degree)};
  const Vec3 up = cross(back, right);
  const double near = 0.5, far = 4, f = 1 / std::tan(20 * degree);
  const Matrix4 projection{
      f, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), 2 * far * near / (near - far), 0, 0, -1, 0};
  const Matrix4 camera{right[0], right[1], right[2], 0,  up[0], up[1], up[2], 0,
                       back[0],  back[1],  back[2],  -2, 0,     0,     0,     1};
  const Matrix4 centred{1, 0, 0, -0.5, 0, 1, 0, -0.5, 0, 0, 1, -0.5, 0, 0, 0, 1};
  return multiply(projection, multiply(camera, centred));
}

/// Arranges ranks [first, last) one behind the other along z, in cells [low, high). Returns the index of the
/// split, or ~rank for a single rank.
int halve(Partition& partition, int first, int last, int low, int high) {
  if (last - first == 1) return ~first;
  const int middle = (first + last) / 2;
  const int cut = low + (high - low) * (middle - first) / (last - first);
  const auto place = int(partition.splits.size());
  partition.splits.push_back({2, cut, 0, 0});
  const int below = halve(partition, first, middle, low, cut),
            above = halve(partition, middle, last, cut, high);
  partition.splits[std::size_t(place)].low = below;
  partition.splits[std::size_t(place)].high = above;
  return place;
}

Partition slice_ranges(const VolumeDescription& description, int ranks) {
  const TexelBox cells = cell_lattice(description).box();
  Partition partition;
  partition.ranks = ranks;
  halve(partition, 0, ranks, cells.low[2], cells.high[2]);
  return partition;
}

PartialImage noise(int pixels, int rank, int ranks) {
  PartialImage result{Image({0, 0, pixels, pixels}), std::vector<int>(std::size_t(ranks))};
  std::iota(result.order.begin(), result.order.end(), 0);
  std::mt19937 random{unsigned(rank)};
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::size_t i = 0; i < result.image.rgba.size(); i += 4) {
    const float alpha = 0.05F + 0.9F * uniform(random);
    for (std::size_t c = 0; c < 3; ++c) result.image.rgba[i + c] = alpha * uniform(random);
    result.image.rgba[i + 3] = alpha;
  }
  return result;
}

}  // namespace

std::string_view name_of(Scene scene) {
  switch (scene) {
    case Scene::full:
      return "full";
    case Scene::sparse:
      return "sparse";
    case Scene::noise:
      return "noise";
  }
  return "";
}

PartialImage partial_image(Scene scene, int pixels, std::span<const std::byte> texels, int side, int rank,
                           int ranks) {
  if (scene == Scene::noise) return noise(pixels, rank, ranks);
  VolumeDescription description;
  description.id = description.version = 1;
  description.size = {side, side, side};
  description.stored = {{0, 0, 0}, description.size};
  RenderRequest request;
  request.volume = request.version = 1;
  request.texture_to_clip = scene == Scene::full ? parallel_view() : perspective_view();
  request.viewport = request.window = {0, 0, pixels, pixels};
  request.steps.emplace();
  request.steps->metric = {double(side), 0, 0, 0, double(side), 0, 0, 0, double(side)};
  request.classification = transfer_function(scene);
  const KdTree tree =
      scene == Scene::full ? KdTree(description, slice_ranges(description, ranks)) : KdTree(description, ranks);
  BrickStore bricks(description, tree.box(rank));
  bricks.add_slices(description.stored, texels);
  bricks.finish();
  PartialImage result{Image(footprint(request, description, tree.box(rank))), tree.visibility_order(request)};
  FrameCounts counts;
  raycast(bricks, request, result.image, counts);
  compositor::crop_to_content(result.image, request.op);
  return result;
}

}  // namespace understudy::bench
