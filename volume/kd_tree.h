// Static partition of a volume's cells into one convex box per rank, and the order in which the boxes cover
// each other. Split planes lie on block faces where that is possible. (Bentley 1975; for sort-last volume
// rendering Ma, Painter, Hansen, Krogh 1994.)
#pragma once

#include <vector>

#include "volume/brick/cell_lattice.h"
#include "volume/request.h"
#include "volume/sight.h"

namespace understudy::volume {

/// Most ranks that are believed.
constexpr int max_ranks = 65536;

class KdTree {
 public:
  /// Divides the cell lattice of `volume` among `ranks` >= 1, in proportion to the ranks on either side of
  /// every split. With more ranks than cells some boxes are empty. Throws std::invalid_argument.
  KdTree(const VolumeDescription& volume, int ranks);

  int ranks() const { return int(boxes_.size()); }

  /// The cells of `rank`, half-open. Boxes of all ranks tile the lattice.
  const TexelBox& box(int rank) const { return boxes_[std::size_t(rank)]; }

  /// All ranks, in the order in which a request's samples meet their boxes: on every ray, samples in a box
  /// named earlier have smaller plane indices. Follows the planes, so that it also holds for reversed depth.
  /// Exact for any camera while the planes keep one order over the picture; they do not when the eye lies
  /// between slices that do not face it, where the application's own order is wrong on one side. Throws
  /// std::invalid_argument when the matrix is singular.
  std::vector<int> visibility_order(const RenderRequest& request) const;

  /// All ranks, nearest (smallest depth) first. Perspective, parallel, mirrored; eye inside or outside.
  std::vector<int> visibility_order(const Matrix4& texture_to_clip) const;

 private:
  struct Node {
    int axis = 0;
    double plane = 0;  // in texture space
    int low = 0;       // child on the low side: a node, or ~rank
    int high = 0;
  };

  int divide(const VolumeDescription& volume, const TexelBox& lattice, const TexelBox& cells, int first_rank,
             int ranks);
  std::vector<int> visibility_order(const Sight& sight) const;
  void walk(int child, const Sight& sight, std::vector<int>& order) const;

  std::vector<TexelBox> boxes_;
  std::vector<Node> nodes_;
  int root_ = 0;
};

}  // namespace understudy::volume
