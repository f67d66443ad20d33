// SPDX-License-Identifier: Apache-2.0
// Which of two neighbours a request's rays meet first.
#pragma once

#include "volume/matrix.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// The order of two half-spaces along the rays of one camera (Fuchs, Kedem, Naylor 1980). Applied to every
/// plane of a kd-tree it is the visibility order of its boxes.
class VisibilityOrder {
 public:
  /// Nearest (smallest depth) first. Perspective, parallel, mirrored; eye inside or outside. Throws
  /// std::invalid_argument when the matrix is singular.
  explicit VisibilityOrder(const Matrix4& texture_to_clip);
  /// As the request's samples are counted, so that it also holds for planes in order of falling depth.
  explicit VisibilityOrder(const RenderRequest& request);

  /// Of what a plane across `axis` parts: whether the side of higher coordinates comes first. `plane` is in
  /// texture space.
  bool high_first(int axis, double plane) const {
    // A ray crosses the plane towards -(eye - plane * eye.w), whatever the sign of eye.w: no division, so
    // nearly parallel projections need no care.
    return (eye_[axis] - plane * eye_[3] > 0) != reversed_;
  }

 private:
  /// The eye in homogeneous texture space, scaled such that depth grows along -eye; at infinity (w = 0) for a
  /// parallel projection. It is the point whose clip x, y and w vanish.
  Vec4 eye_{};
  bool reversed_ = false;
};

}  // namespace understudy::volume
