// SPDX-License-Identifier: Apache-2.0
// Where the volume unit's part of a frame goes: recognising, reading depth, uploading, rendering,
// verifying, presenting.
#pragma once

#include <chrono>

#include "spu/report/counters.h"

namespace understudy::spu {

/// At any time at most one share of the frame is being timed.
class FrameClock {
 public:
  using Share = double FrameShares::*;

  /// What was timed since the last call.
  FrameShares take();

 private:
  friend class TimedShare;
  using Clock = std::chrono::steady_clock;

  /// nullptr: the application's own time. Gives what was timed until now.
  Share switch_to(Share share);

  FrameShares sum_{};
  Share share_ = nullptr;
  Clock::time_point since_{};
};

/// Counts the time it lives to one share, and not to the share around it.
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
