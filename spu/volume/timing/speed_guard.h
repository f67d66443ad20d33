// SPDX-License-Identifier: Apache-2.0
// Never slower than the viewer: an account of time bounds what trying to substitute a volume may cost.
//
// What an attempt takes is paid from the account: all of it where it ended in a refusal, what it took longer
// than the application's own drawing where it was shown; an image that was faster pays in. While the account is
// in debt the application draws, and a fiftieth of the time that passes is paid in. So attempts that gain
// nothing take at most 2 % of the time, however often and for whatever reason they fail, after a first look
// that is short.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace understudy::spu {

class SpeedGuard {
 public:
  using Clock = std::chrono::steady_clock;

  /// A run of the volume is about to be drawn. `state` stands for what the verdict may depend on: the program
  /// and the volume's contents. Where that is another, the volume is looked at again, at most every
  /// state_pause.
  void about_to_draw(std::uint64_t state, Clock::time_point now);
  /// Whether the application draws.
  bool pauses(Clock::time_point now) const;

  /// An attempt ended in a refusal, after so many milliseconds.
  void refused(double ms, Clock::time_point now);
  /// A run was shown in `ours_ms`, with all comparisons; the application's own drawing would have taken
  /// `native_ms`.
  void shown(double ours_ms, double native_ms, Clock::time_point now);
  /// The next attempt is likely to succeed, and is made whatever the account says.
  void allow_another() { allowed_ = true; }

  /// The sentence where images were shown and took longer; empty: it was for another reason that attempts
  /// ended.
  const std::string& slower() const { return slower_; }

  static constexpr double share_for_attempts = 0.02;
  /// A viewer's first frames may show nothing yet, or a volume that is still being loaded: they are a first
  /// look. A refusal after an image was shown ends it.
  static constexpr int first_attempts = 3;
  /// Refusals that took longer in all end the first look.
  static constexpr double first_look_ms = 300;
  /// The account holds at most this many frames of the application's: what was gained long ago does not excuse
  /// being slower now.
  static constexpr double most_saved_frames = 4;
  static constexpr auto state_pause = std::chrono::seconds(5);

 private:
  double account_ms(Clock::time_point now) const;
  void pay(double ms, Clock::time_point now);

  double account_ms_ = 0;  ///< at paid_
  Clock::time_point paid_{};
  std::uint64_t state_ = 0;
  Clock::time_point state_since_{};
  int attempts_ = 0;
  bool shown_in_state_ = false;
  double refused_ms_ = 0;
  bool ever_shown_ = false;
  bool allowed_ = false;
  std::string slower_;
};

}  // namespace understudy::spu
