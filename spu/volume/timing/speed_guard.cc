// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/speed_guard.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace understudy::spu {

double SpeedGuard::account_ms(Clock::time_point now) const {
  if (account_ms_ >= 0) return account_ms_;
  const double passed_ms = std::chrono::duration<double, std::milli>(now - paid_).count();
  return std::min(0.0, account_ms_ + share_for_attempts * passed_ms);
}

void SpeedGuard::pay(double ms, Clock::time_point now) {
  account_ms_ = account_ms(now) - ms;
  paid_ = now;
}

void SpeedGuard::about_to_draw(std::uint64_t state, Clock::time_point now) {
  if (state == state_ || (attempts_ > 0 && now - state_since_ < state_pause)) return;
  state_ = state;
  state_since_ = now;
  attempts_ = 0;
  refused_ms_ = compared_frames_ = 0;
}

bool SpeedGuard::pauses(Clock::time_point now) const {
  const bool first_look = attempts_ < first_attempts && refused_ms_ <= first_look_ms;
  return !allowed_ && !first_look && account_ms(now) < 0;
}

void SpeedGuard::refused(double ms, Clock::time_point now) {
  ++attempts_;
  allowed_ = false;
  refused_ms_ += ms;
  slower_.clear();
  pay(ms, now);
}

void SpeedGuard::shown(const Shown& costs, Clock::time_point now) {
  ++attempts_;
  allowed_ = false;
  double longer_ms = costs.ours_ms - costs.native_ms;
  if (costs.native_ms > 0 && compared_frames_ < free_comparisons) {
    compared_frames_ += costs.comparison_ms / costs.native_ms;
  } else {
    longer_ms += costs.comparison_ms;
  }
  if (!std::exchange(ever_shown_, true)) {
    // The first image pays for what is measured once, and redeems the attempts before it.
    account_ms_ = 0;
    longer_ms = std::min(longer_ms, 0.0);
  }
  pay(longer_ms, now);
  account_ms_ = std::min(account_ms_, most_saved_frames * costs.native_ms);
  slower_ = account_ms_ >= 0
                ? std::string()
                : fmt::format(
                      "substituting it takes {:.3g} ms, the viewer's own drawing {:.3g} ms (--speed-guard off "
                      "substitutes it all the same)",
                      costs.native_ms + longer_ms, costs.native_ms);
}

}  // namespace understudy::spu
