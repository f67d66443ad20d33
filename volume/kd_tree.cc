#include "volume/kd_tree.h"

#include <stdexcept>
#include <utility>

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

}  // namespace

KdTree::KdTree(const VolumeDescription& volume, Partition partition)
    : partition_(std::move(partition)), boxes_(volume::boxes(partition_, volume)) {
  for (const Partition::Split& split : partition_.splits)
    planes_.push_back((split.cut + 0.5) / volume.size[std::size_t(split.axis)]);
}

KdTree::KdTree(const VolumeDescription& volume, int ranks) : KdTree(volume, by_blocks(volume, ranks)) {}

void KdTree::walk(int child, const std::array<double, 4>& eye, bool reversed, std::vector<int>& order) const {
  if (child < 0) {
    order.push_back(~child);
    return;
  }
  const Partition::Split& node = partition_.splits[std::size_t(child)];
  // A ray crosses the plane towards -(eye - plane * eye.w), whatever the sign of eye.w: no division, so
  // nearly parallel projections need no care.
  const bool high_first = (eye[std::size_t(node.axis)] - planes_[std::size_t(child)] * eye[3] > 0) != reversed;
  walk(high_first ? node.high : node.low, eye, reversed, order);
  walk(high_first ? node.low : node.high, eye, reversed, order);
}

std::vector<int> KdTree::visibility_order(const Matrix4& texture_to_clip) const {
  std::vector<int> order;
  order.reserve(boxes_.size());
  walk(root(), eye_of(texture_to_clip), false, order);
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
  walk(root(), eye, towards_eye > 0, order);
  return order;
}

}  // namespace understudy::volume
