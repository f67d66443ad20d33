// SPDX-License-Identifier: Apache-2.0
// Which vectors and matrices of a ray caster's program move with the camera. One that stayed while the camera
// moved, and then changes, is something else: a light, a colour, a corner that is cut off. So is one that comes
// back to what it was while the camera moves on.
#pragma once

#include <vector>

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

class CameraFollowers {
 public:
  /// Which of `now.varying` may have changed because the camera `turned` since the image that was drawn under
  /// `before`. To be called before every image.
  std::vector<bool> look(const MarchInputs& before, const MarchInputs& now, bool turned);

 private:
  /// Of one vector.
  struct Moves {
    int stayed = 0;   ///< the last so many moves of the camera
    int doubted = 0;  ///< it must change so many times more before it counts as a follower again
  };
  std::vector<Moves> vectors_;
  std::vector<float> earlier_;  ///< what varies, in the image before the last one
};

}  // namespace understudy::spu
