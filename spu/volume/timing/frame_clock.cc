// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/frame_clock.h"

#include <utility>

namespace understudy::spu {

FrameClock::Share FrameClock::switch_to(Share share) {
  const Clock::time_point now = Clock::now();
  if (share_ != nullptr) sum_.*share_ += std::chrono::duration<double, std::milli>(now - since_).count();
  since_ = now;
  return std::exchange(share_, share);
}

FrameShares FrameClock::take() {
  return std::exchange(sum_, {});
}

}  // namespace understudy::spu
