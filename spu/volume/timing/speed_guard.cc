// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/speed_guard.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::spu {

void SpeedGuard::begin_window(Clock::time_point now) {
  window_began_ = now;
  runs_ = 0;
  ours_ms_ = native_ms_ = 0;
}

void SpeedGuard::substituted(double ours_ms, double native_ms, Clock::time_point now) {
  if (!window_began_ || now - *window_began_ > 2 * shortest_window) begin_window(now);
  ++runs_;
  ours_ms_ += ours_ms;
  native_ms_ += native_ms;
  if (runs_ < fewest_runs || now - *window_began_ < shortest_window) return;
  if (ours_ms_ > slower * native_ms_) {
    reason_ = fmt::format(
        "substituting it takes {:.3g} ms, the viewer's own drawing {:.3g} ms (--speed-guard off substitutes it "
        "all "
        "the same)",
        ours_ms_ / runs_, native_ms_ / runs_);
    native_until_ = now + pause_;
    pause_ = std::min<Clock::duration>(2 * pause_, longest_pause);
    window_began_.reset();
  } else {
    pause_ = first_pause;
    begin_window(now);
  }
}

std::string SpeedGuard::reason(Clock::time_point now) const {
  return now < native_until_ ? reason_ : std::string();
}

}  // namespace understudy::spu
