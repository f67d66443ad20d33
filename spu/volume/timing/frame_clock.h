// SPDX-License-Identifier: Apache-2.0
// Measures the volume unit's part of a frame: recognition, reading of depth, upload, rendering, verification,
// presentation.
#pragma once

#include <chrono>

#include "spu/report/counters.h"

namespace understudy::spu {

/// At any time at most one share of the frame is timed.
class FrameClock {
 public:
  using Share = double FrameShares::*;

  /// Returns what was timed since the last call.
  FrameShares take();

 private:
  friend class TimedShare;
  using Clock = std::chrono::steady_clock;

  /// Returns the share that was timed until now; nullptr: the application's own time.
  Share switch_to(Share share);

  FrameShares sum_{};
  Share share_ = nullptr;
  Clock::time_point since_{};
};

/// Adds the time of its scope to one share, and not to the share around it.
class TimedShare {
 public:
  TimedShare(FrameClock& clock, FrameClock::Share share) : clock_(clock), around_(clock.switch_to(share)) {}
  ~TimedShare() { clock_.switch_to(around_); }
  TimedShare(const TimedShare&) = delete;
  TimedShare& operator=(const TimedShare&) = delete;

 private:
  FrameClock& clock_;
  FrameClock::Share around_;
};

}  // namespace understudy::spu
