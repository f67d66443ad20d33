// SPDX-License-Identifier: Apache-2.0
// Which of two neighbouring boxes a request's rays reach first.
#pragma once

#include "volume/matrix.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// The order of two half-spaces along the rays of one camera (Fuchs, Kedem, Naylor 1980). Applied to every
/// plane of a kd-tree, it gives the visibility order of the boxes.
class VisibilityOrder {
 public:
  /// Nearest (smallest depth) first. Perspective, parallel, mirrored; eye inside or outside. Throws
  /// std::invalid_argument when the matrix is singular.
  explicit VisibilityOrder(const Matrix4& texture_to_clip);
  /// In the order of the request's samples, so that it also holds for planes of decreasing depth.
  explicit VisibilityOrder(const RenderRequest& request);

  /// Of the two sides of a plane across `axis`: whether the side of higher coordinates comes first. `plane` is
  /// in texture space.
  bool high_first(int axis, double plane) const {
    // A ray crosses the plane in the direction -(eye - plane * eye.w), whatever the sign of eye.w. Without a
    // division, nearly parallel projections need no special case.
    return (eye_[axis] - plane * eye_[3] > 0) != reversed_;
  }

 private:
  /// The eye in homogeneous texture space, scaled so that depth increases along -eye; at infinity (w = 0) for a
  /// parallel projection. It is the point whose clip x, y and w are zero.
  Vec4 eye_{};
  bool reversed_ = false;
};

}  // namespace understudy::volume
