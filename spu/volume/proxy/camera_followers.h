// SPDX-License-Identifier: Apache-2.0
// Which vectors and matrices of a ray caster's program move with the camera. A vector that stayed while the
// camera moved, and changes later, is something else: a light, a colour, a corner that is cut off. So is a
// vector that returns to an earlier value while the camera moves on, until such returns have been right a few
// times (one vector for each eye of a stereo pair). A vector that decides, by a branch, which samples are
// skipped is not trusted again.
#pragma once

#include <cstdint>
#include <vector>

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

class CameraFollowers {
 public:
  /// How the camera has moved since the last image.
  enum class Camera : std::uint8_t {
    stayed,
    came_back,  ///< to its state in the image before the last: two views alternate
    moved_on
  };

  /// Returns, number by number, which of `now.varying` may have changed because the camera moved since the
  /// image that was drawn under `before`. Must be called before every image.
  std::vector<bool> look(const MarchInputs& before, const MarchInputs& now, Camera camera);
  /// Must be called when the last image was wrong.
  void was_wrong();

 private:
  /// The history of one vector.
  struct Moves {
    std::size_t name = 0;   ///< as in MarchInputs::varying_names
    int stayed = 0;         ///< number of the camera's last moves in which it stayed
    int until_trusted = 0;  ///< changes with the camera that are needed before it counts as a follower again
    int returned = 0;       ///< times that it returned to an earlier value and the image was right
    bool chose = false;     ///< as in MarchInputs::varying_chooses, in the last image
  };
  Moves& moves_of(std::size_t name, bool chooses, bool is_first);

  std::vector<Moves> vectors_;  ///< of all images
  MarchInputs earlier_;         ///< of the image before the last one
};

}  // namespace understudy::spu
