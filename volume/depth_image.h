// SPDX-License-Identifier: Apache-2.0
// The depth of the opaque geometry that the application has drawn before the volume.
#pragma once

#include <vector>

#include "volume/rect.h"

namespace understudy::volume {

/// Window depth in [0,1] of the opaque geometry already drawn. Samples that are not nearer are hidden.
struct DepthImage {
  Rect rect;
  std::vector<float> depth;  ///< rows bottom up
  bool or_equal = false;     ///< depth test: true is GL_LEQUAL, false is GL_LESS
  bool operator==(const DepthImage&) const = default;
};

}  // namespace understudy::volume
