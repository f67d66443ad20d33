// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/timing/speed_guard.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::spu {

double SpeedGuard::account_ms(Clock::time_point now) const {
  if (account_ms_ >= 0) return account_ms_;
  const double passed_ms = std::chrono::duration<double, std::milli>(now - paid_).count();
  return std::min(0.0, account_ms_ + share_ * passed_ms);
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
  shown_in_state_ = false;
  refused_ms_ = 0;
  surcharge_ = 1;
}

bool SpeedGuard::pauses(Clock::time_point now) const {
  const bool first_look = attempts_ < first_attempts && refused_ms_ <= first_look_ms;
  return !allowed_ && !first_look && account_ms(now) < 0;
}

void SpeedGuard::refused(double ms, Clock::time_point now) {
  attempts_ = shown_in_state_ ? first_attempts : attempts_ + 1;
  allowed_ = false;
  refused_ms_ += ms;
  slower_.clear();
  pay(ms, now);
}

void SpeedGuard::shown(double ours_ms, double native_ms, Clock::time_point now) {
  ++attempts_;
  allowed_ = false;
  if (ever_shown_) {
    pay(ours_ms - native_ms, now);
  } else {
    // The first image includes what is measured once: it is not charged, and clears the charges of earlier
    // attempts.
    account_ms_ = 0;
  }
  ever_shown_ = shown_in_state_ = true;
  account_ms_ = std::min(account_ms_, most_saved_frames * native_ms);
  slower_.clear();
  if (ours_ms <= native_ms) surcharge_ = 1;
  if (account_ms_ >= 0) return;
  if (attempts_ >= first_attempts && ours_ms > native_ms) {
    surcharge_ = std::min(2 * surcharge_, largest_surcharge);
    account_ms_ *= surcharge_;
  }
  slower_ =
      fmt::format("substituting it took {:.3g} ms, the viewer's own drawing {:.3g} ms", ours_ms, native_ms);
}

}  // namespace understudy::spu
