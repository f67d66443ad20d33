// SPDX-License-Identifier: Apache-2.0
// How far the ranks are in reading a volume, on standard error: a bar that is drawn over itself, or lines.
#pragma once

#include <span>
#include <string>

#include "compositor/service/loading_service.h"

namespace understudy::launcher {

/// "loading  42 % [########            ] 110 MiB read by 4 ranks"
std::string progress_text(std::span<const compositor::RankLoad> ranks);

class LoadProgress {
 public:
  /// silent: nothing; bar: for a terminal; lines: one for each step, with what every rank has read.
  enum class Style { silent, bar, lines };

  explicit LoadProgress(Style style) : style_(style) {}
  LoadProgress(const LoadProgress&) = delete;
  LoadProgress& operator=(const LoadProgress&) = delete;
  ~LoadProgress();

  void show(std::span<const compositor::RankLoad> ranks);

 private:
  Style style_;
  bool drawn_ = false;
};

}  // namespace understudy::launcher
