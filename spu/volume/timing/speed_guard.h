// SPDX-License-Identifier: Apache-2.0
// Never slower than the viewer: what substituting a volume costs is held against what the application's own
// drawing costs, which is measured whenever an image is compared whole. Where substituting was slower over a
// second, the application draws; it is tried again after a pause, which grows as long as nothing has changed.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace understudy::spu {

class SpeedGuard {
 public:
  using Clock = std::chrono::steady_clock;

  /// A run was substituted in `ours_ms`, where the application's own drawing takes about `native_ms`.
  void substituted(double ours_ms, double native_ms, Clock::time_point now);

  /// Why the application draws now; empty: the volume is substituted.
  std::string reason(Clock::time_point now) const;

 private:
  static constexpr auto shortest_window = std::chrono::seconds(1);
  /// The first runs pay for what is measured once.
  static constexpr int fewest_runs = 8;
  /// Measurements of both sides scatter by some percent.
  static constexpr double slower = 1.05;
  static constexpr auto first_pause = std::chrono::seconds(5);
  static constexpr auto longest_pause = std::chrono::seconds(80);

  void begin_window(Clock::time_point now);

  std::optional<Clock::time_point> window_began_;
  int runs_ = 0;
  double ours_ms_ = 0;
  double native_ms_ = 0;
  Clock::time_point native_until_{};
  Clock::duration pause_ = first_pause;
  std::string reason_;
};

}  // namespace understudy::spu
