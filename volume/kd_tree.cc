#include "volume/kd_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volume/brick/brick_store.h"
#include "volume/matrix.h"

namespace understudy::volume {

namespace {

/// The eye in homogeneous texture space, scaled such that depth grows along -eye; at infinity (w = 0) for a
/// parallel projection. It is the point whose clip x, y and w vanish.
Vec4 eye_of(const Matrix4& texture_to_clip) {
  const auto clip_to_texture = inverse(texture_to_clip);
  if (!clip_to_texture) throw std::invalid_argument("the matrix from texture to clip space is singular");
  const Vec4 column = transform(*clip_to_texture, {0, 0, 1, 0});
  return {-column[0], -column[1], -column[2], -column[3]};
}

/// The middle of the region, or its deepest corner when the middle lies behind the eye.
Vec3 seen_point(const RenderRequest& request) {
  const auto depth = [&](const Vec3& t) { return transform_point(request.texture_to_clip, t)[3]; };
  const Box& region = request.region;
  Vec3 point = scale(add(region.low, region.high), 0.5);
  if (depth(point) > 0) return point;
  for (int axis = 0; axis < 3; ++axis)
    point[axis] = request.texture_to_clip[12 + axis] > 0 ? region.high[axis] : region.low[axis];
  return point;
}

/// Where to cut `extent` cells (starting `offset` cells into the lattice) for `left` of `ranks`: on the block
/// face nearest to the fair share, or between any two cells when no block face lies inside.
int split_position(int offset, int extent, int left, int ranks) {
  constexpr int block = BrickStore::block_cells;
  const double fair = double(extent) * left / ranks;
  const int lowest = (offset / block + 1) * block - offset;              // first block face inside
  const int highest = ((offset + extent - 1) / block) * block - offset;  // last one
  if (lowest > highest) return std::clamp(int(std::lround(fair)), 1, extent - 1);
  const int nearest = int(std::lround((offset + fair) / block)) * block - offset;
  return std::clamp(nearest, lowest, highest);
}

}  // namespace

KdTree::KdTree(const VolumeDescription& volume, int ranks) {
  if (ranks < 1 || ranks > max_ranks)
    throw std::invalid_argument(
        fmt::format("a volume cannot be divided among {} ranks (1 to {} are possible)", ranks, max_ranks));
  boxes_.resize(std::size_t(ranks));
  const TexelBox lattice = cell_lattice(volume).box();
  root_ = divide(volume, lattice, lattice, 0, ranks);
}

int KdTree::divide(const VolumeDescription& volume, const TexelBox& lattice, const TexelBox& cells,
                   int first_rank, int ranks) {
  if (ranks == 1) {
    boxes_[std::size_t(first_rank)] = cells;
    return ~first_rank;
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (cells.high[k] - cells.low[k] > cells.high[axis] - cells.low[axis]) axis = k;
  const int extent = cells.high[axis] - cells.low[axis];
  const int left_ranks = ranks / 2;
  const int cut = extent < 2 ? cells.high[axis]
                             : cells.low[axis] + split_position(cells.low[axis] - lattice.low[axis], extent,
                                                                left_ranks, ranks);

  const int index = int(nodes_.size());
  nodes_.push_back({axis, (cut + 0.5) / volume.size[axis], 0, 0});
  TexelBox low = cells, high = cells;
  low.high[axis] = cut;
  high.low[axis] = cut;
  const int low_child = divide(volume, lattice, low, first_rank, left_ranks);
  const int high_child = divide(volume, lattice, high, first_rank + left_ranks, ranks - left_ranks);
  nodes_[std::size_t(index)].low = low_child;
  nodes_[std::size_t(index)].high = high_child;
  return index;
}

void KdTree::walk(int child, const std::array<double, 4>& eye, bool reversed, std::vector<int>& order) const {
  if (child < 0) {
    order.push_back(~child);
    return;
  }
  const Node& node = nodes_[std::size_t(child)];
  // A ray crosses the plane towards -(eye - plane * eye.w), whatever the sign of eye.w: no division, so
  // nearly parallel projections need no care.
  const bool high_first = (eye[node.axis] - node.plane * eye[3] > 0) != reversed;
  walk(high_first ? node.high : node.low, eye, reversed, order);
  walk(high_first ? node.low : node.high, eye, reversed, order);
}

std::vector<int> KdTree::visibility_order(const Matrix4& texture_to_clip) const {
  std::vector<int> order;
  order.reserve(boxes_.size());
  walk(root_, eye_of(texture_to_clip), false, order);
  return order;
}

std::vector<int> KdTree::visibility_order(const RenderRequest& request) const {
  if (request.steps) return visibility_order(request.texture_to_clip);  // steps are counted along depth
  const Vec4 eye = eye_of(request.texture_to_clip);
  // The plane through a point that can be seen says whether plane indices rise with depth or fall.
  const Vec3& n = request.planes.normal;
  const double towards_eye =
      request.planes.spacing * (dot(n, {eye[0], eye[1], eye[2]}) - dot(n, seen_point(request)) * eye[3]);
  std::vector<int> order;
  order.reserve(boxes_.size());
  walk(root_, eye, towards_eye > 0, order);
  return order;
}

}  // namespace understudy::volume
