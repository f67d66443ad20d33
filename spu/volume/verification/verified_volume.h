// SPDX-License-Identifier: Apache-2.0
// What is remembered of the comparisons of one volume.
#pragma once

#include <cstddef>
#include <string>

#include "spu/volume/verification/schedule.h"

namespace understudy::spu {

struct VerifiedVolume {
  VerificationSchedule schedule;
  /// Kinds of state that the application had set when the latest image was shown (observation/state_kinds.h).
  std::size_t state_kinds = 0;
  bool inside = false;      ///< an image with the eye inside was equal to the application's
  std::string left_inside;  ///< why it is not substituted while the eye is inside; empty: it is
};

}  // namespace understudy::spu
