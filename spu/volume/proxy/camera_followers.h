// SPDX-License-Identifier: Apache-2.0
// Which vectors and matrices of a ray caster's program move with the camera. One that stayed while the camera
// moved, and then changes, is something else: a light, a colour, a corner that is cut off. So is one that comes
// back to what it was while the camera moves on, until that has been right a few times (one for each eye of a
// stereo pair). One that decides, by a branch, which samples are left out is not trusted again.
#pragma once

#include <cstdint>
#include <vector>

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

class CameraFollowers {
 public:
  /// How the camera has moved since the image that was drawn last.
  enum class Camera : std::uint8_t {
    stayed,
    came_back,  ///< to what it was in the image before that: two views take turns
    moved_on
  };

  /// Which of `now.varying` may have changed because the camera did, since the image that was drawn under
  /// `before`. To be called before every image.
  std::vector<bool> look(const MarchInputs& before, const MarchInputs& now, Camera camera);
  /// The last image was wrong.
  void was_wrong();

 private:
  /// Of one vector.
  struct Moves {
    std::size_t name = 0;   ///< as of MarchInputs
    int stayed = 0;         ///< the last so many moves of the camera
    int until_trusted = 0;  ///< it must change so many times more before it counts as a follower again
    int returned = 0;       ///< so often it came back to what it was, and the image was right
    bool chose = false;     ///< as of MarchInputs, in the last image
  };
  Moves& moves_of(std::size_t name, bool chooses, bool is_first);

  std::vector<Moves> vectors_;  ///< of all images
  MarchInputs earlier_;         ///< of the image before the last one
};

}  // namespace understudy::spu
