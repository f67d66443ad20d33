// SPDX-License-Identifier: Apache-2.0
// Divides the cells of a volume into one convex box per rank, according to a partition, and orders the boxes by
// visibility. (Bentley 1975; for sort-last volume rendering Ma, Painter, Hansen, Krogh 1994.)
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

/// A partition with the resulting boxes, and their visibility order for a request.
class KdTree {
 public:
  /// Throws std::invalid_argument when `partition` does not divide the cell lattice of `volume`.
  KdTree(const VolumeDescription& volume, Partition partition);
  /// Partitions by blocks among `ranks` >= 1. With more ranks than cells some boxes are empty. Throws
  /// std::invalid_argument.
  KdTree(const VolumeDescription& volume, int ranks);

  const Partition& partition() const { return partition_; }

  int ranks() const { return int(boxes_.size()); }

  /// The cells of `rank`, half-open. The boxes of all ranks tile the shown cells.
  const TexelBox& box(int rank) const { return boxes_[std::size_t(rank)]; }

  /// All ranks in visibility order: on every ray, the samples in a rank's box have smaller plane indices than
  /// those in boxes later in the list. The order follows the planes, so it also holds for reversed depth. Exact
  /// for any camera as long as the planes have the same order over the whole image. They do not when the eye
  /// lies between slices that do not face it; there, the application's own order is wrong on one side. Throws
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
