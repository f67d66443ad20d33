// SPDX-License-Identifier: Apache-2.0
// How far the ranks are in reading a volume, on standard error: a bar that is drawn over itself, or lines.
#pragma once

#include <span>
#include <string>

#include "compositor/service/loading_service.h"

namespace understudy::launcher {

/// "loading  42 % [########            ] 110 MiB read by 4 ranks"
std::string progress_text(std::span<const compositor::RankLoad> ranks);
/// The same of one of several parts: "part 2 of 5: loading …".
std::string progress_text(int part, int parts, std::span<const compositor::RankLoad> ranks);

class LoadProgress {
 public:
  /// silent: nothing; bar: for a terminal; lines: one for each step, with what every rank has read.
  enum class Style { silent, bar, lines };

  explicit LoadProgress(Style style) : style_(style) {}
  LoadProgress(const LoadProgress&) = delete;
  LoadProgress& operator=(const LoadProgress&) = delete;
  ~LoadProgress();

  void show(std::span<const compositor::RankLoad> ranks) { show(0, 1, ranks); }
  /// Of part `part`, counted from 0, of `parts`.
  void show(int part, int parts, std::span<const compositor::RankLoad> ranks);

 private:
  Style style_;
  bool drawn_ = false;
  std::size_t shown_ = 0;  ///< characters
};

}  // namespace understudy::launcher
