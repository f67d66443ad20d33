// SPDX-License-Identifier: Apache-2.0
// Prints the progress of long work to standard error: on a terminal, as one line that is overwritten, and
// erased at the end; elsewhere nothing, or as permanent lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace understudy::launcher {

enum class ProgressStyle : std::uint8_t { silent, line, lines };

/// One line on terminals, silent elsewhere.
ProgressStyle usual_progress();

class Progress {
 public:
  explicit Progress(ProgressStyle style) : style_(style) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  ProgressStyle style() const { return style_; }
  /// `done` is the fraction of the work, from 0 to 1; `text` describes it. May be called from any thread.
  /// Permanent lines are written for every tenth of the work, and after two seconds without one.
  void show(double done, std::string_view text);

 private:
  bool is_due(double done);

  const ProgressStyle style_;
  std::mutex mutex_;
  std::string shown_;      ///< the line on the terminal
  double next_share_ = 0;  ///< fraction of the work at which the next permanent line is due
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace understudy::launcher
