// SPDX-License-Identifier: Apache-2.0
// Never slower than the viewer: an account of time limits what attempts to substitute a volume may cost.
//
// An attempt is charged to the account: all of its time if it ended in a refusal, the time beyond that of the
// application's own drawing if its image was shown; an image that was faster is credited. While the account is
// negative, the application draws, and a fiftieth of the elapsed time is credited. Attempts that gain nothing
// therefore take at most 2 % of the time, however often and for whatever reason they fail, after a short first
// look. An image that was slower than the application's own drawing is likely to be slower again: each such
// attempt in a row is charged twice as much as the one before, so that its share falls to an eighth of a
// percent.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace understudy::spu {

class SpeedGuard {
 public:
  using Clock = std::chrono::steady_clock;

  /// Called before a run of the volume is drawn. `state` identifies what the verdict may depend on: the program
  /// and the volume's contents. When it changes, a new first look begins, at most every state_pause.
  void about_to_draw(std::uint64_t state, Clock::time_point now);
  /// That many volumes share the time for attempts: a volume in many textures may be hundreds.
  void share_among(std::size_t volumes) {
    share_ = share_for_attempts / double(std::max<std::size_t>(volumes, 1));
  }
  /// Whether the application draws.
  bool pauses(Clock::time_point now) const;

  /// An attempt ended in a refusal after `ms` milliseconds.
  void refused(double ms, Clock::time_point now);
  /// A run was shown in `ours_ms`, including all comparisons; the application's own drawing would have taken
  /// `native_ms`.
  void shown(double ours_ms, double native_ms, Clock::time_point now);
  /// The next attempt is likely to succeed, and is made whatever the balance of the account.
  void allow_another() { allowed_ = true; }

  /// Both times, as evidence, if images were shown and took longer; empty: attempts ended for another reason.
  const std::string& slower() const { return slower_; }

  static constexpr double share_for_attempts = 0.02;
  /// A viewer's first frames may show nothing yet, or a volume that is still being loaded: this many attempts
  /// are the first look. A refusal after an image was shown ends it.
  static constexpr int first_attempts = 3;
  /// The first look ends when its refusals have taken longer in total.
  static constexpr double first_look_ms = 300;
  /// The account holds at most the time of this many frames of the application: an earlier gain does not excuse
  /// being slower now.
  static constexpr double most_saved_frames = 4;
  static constexpr auto state_pause = std::chrono::seconds(5);
  /// An attempt after the first look that was slower is charged at most so many times.
  static constexpr double largest_surcharge = 16;

 private:
  double account_ms(Clock::time_point now) const;
  void pay(double ms, Clock::time_point now);

  double share_ = share_for_attempts;
  double account_ms_ = 0;  ///< at paid_
  Clock::time_point paid_{};
  std::uint64_t state_ = 0;
  Clock::time_point state_since_{};
  int attempts_ = 0;
  bool shown_in_state_ = false;
  double refused_ms_ = 0;
  double surcharge_ = 1;  ///< of the latest attempt that was slower
  bool ever_shown_ = false;
  bool allowed_ = false;
  std::string slower_;
};

}  // namespace understudy::spu
