// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/progress/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace understudy::launcher {

ProgressStyle usual_progress() {
  return ::isatty(STDERR_FILENO) == 1 ? ProgressStyle::line : ProgressStyle::silent;
}

void Progress::show(double done, std::string_view text) {
  if (style_ == ProgressStyle::silent) return;
  const std::lock_guard lock(mutex_);
  if (style_ == ProgressStyle::lines) {
    if (is_due(done)) std::fputs(fmt::format("understudy: {}\n", text).c_str(), stderr);
    return;
  }
  if (text == shown_) return;
  shown_ = text;
  // Erases the rest of a longer previous line.
  std::fputs(fmt::format("\runderstudy: {}\033[K", text).c_str(), stderr);
  std::fflush(stderr);
}

bool Progress::is_due(double done) {
  constexpr double tenths = 10;
  constexpr std::chrono::seconds longest_silence{2};
  const auto now = std::chrono::steady_clock::now();
  if (done < next_share_ && now - last_ < longest_silence) return false;
  next_share_ = (std::floor(done * tenths) + 1) / tenths;
  last_ = now;
  return true;
}

Progress::~Progress() {
  if (!shown_.empty()) std::fputs("\r\033[K", stderr);
}

}  // namespace understudy::launcher
