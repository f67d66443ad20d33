// SPDX-License-Identifier: Apache-2.0
// A volume's cells in one convex box per rank, as a partition divides them, and the order in which the boxes
// cover each other. (Bentley 1975; for sort-last volume rendering Ma, Painter, Hansen, Krogh 1994.)
#pragma once

#include <array>
#include <vector>

#include "volume/partition.h"
#include "volume/texel_box.h"
#include "volume/texture_space.h"

namespace understudy::volume {

class VisibilityOrder;
struct RenderRequest;
struct VolumeDescription;

/// A partition with the boxes that it makes, and their visibility order for a request.
class KdTree {
 public:
  /// Throws std::invalid_argument when `partition` does not divide the cell lattice of `volume`.
  KdTree(const VolumeDescription& volume, Partition partition);
  /// By blocks, among `ranks` >= 1. With more ranks than cells some boxes are empty. Throws
  /// std::invalid_argument.
  KdTree(const VolumeDescription& volume, int ranks);

  const Partition& partition() const { return partition_; }

  int ranks() const { return int(boxes_.size()); }

  /// The cells of `rank`, half-open. Boxes of all ranks tile the lattice.
  const TexelBox& box(int rank) const { return boxes_[std::size_t(rank)]; }

  /// All ranks, in the order in which a request's samples meet their boxes: on every ray, samples in a box
  /// named earlier have smaller plane indices. Follows the planes, so that it also holds for reversed depth.
  /// Exact for any camera while the planes keep one order over the image; they do not when the eye lies
  /// between slices that do not face it, where the application's own order is wrong on one side. Throws
  /// std::invalid_argument when the matrix is singular.
  std::vector<int> visibility_order(const RenderRequest& request) const;

  /// All ranks, nearest (smallest depth) first. Perspective, parallel, mirrored; eye inside or outside.
  std::vector<int> visibility_order(const Matrix4& texture_to_clip) const;

 private:
  std::vector<int> visibility_order(const VisibilityOrder& visibility) const;
  void walk(int child, const VisibilityOrder& visibility, std::vector<int>& order) const;
  int root() const { return partition_.splits.empty() ? ~0 : 0; }

  Partition partition_;
  std::vector<TexelBox> boxes_;
  std::vector<double> planes_;  // of the splits, in texture space
};

}  // namespace understudy::volume
