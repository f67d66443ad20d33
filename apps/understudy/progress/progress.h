// SPDX-License-Identifier: Apache-2.0
// How far long work is, on standard error: on a terminal a line that is written over itself, and is gone when
// the work is done; elsewhere nothing, or lines that stay.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace understudy::launcher {

enum class ProgressStyle : std::uint8_t { silent, line, lines };

/// A line on terminals, and silence elsewhere.
ProgressStyle usual_progress();

class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  ProgressStyle style() const { return style_; }
  /// `done`: the share of the work, from 0 to 1; `text` says it too. Any thread may call it. Of lines that
  /// stay, one is written for every tenth of the work, and one every two seconds.
  void show(double done, std::string_view text);

 private:
  bool is_due(double done);

  const ProgressStyle style_;
  std::mutex mutex_;
  std::string shown_;      ///< the line on the terminal
  double next_share_ = 0;  ///< at which a line that stays is due
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace understudy::launcher
