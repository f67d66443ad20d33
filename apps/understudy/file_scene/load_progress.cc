// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/load_progress.h"

#include <fmt/format.h>

#include <cstdio>

namespace understudy::launcher {

std::string progress_text(std::span<const compositor::RankLoad> ranks) {
  constexpr int bar_width = 20;
  std::uint64_t done = 0, all = 0, bytes = 0;
  for (const compositor::RankLoad& rank : ranks) {
    done += rank.texels_done;
    all += rank.texels_in_all;
    bytes += rank.bytes_read;
  }
  const double share = all == 0 ? 1.0 : double(done) / double(all);
  const auto filled = std::size_t(share * bar_width);
  return fmt::format("loading {:3} % [{:<{}}] {} MiB read by {} {}", int(share * 100), std::string(filled, '#'),
                     bar_width, bytes >> 20U, ranks.size(), ranks.size() == 1 ? "rank" : "ranks");
}

std::string progress_text(int part, int parts, std::span<const compositor::RankLoad> ranks) {
  if (parts == 1) return progress_text(ranks);
  return fmt::format("part {} of {}: {}", part + 1, parts, progress_text(ranks));
}

void LoadProgress::show(int part, int parts, std::span<const compositor::RankLoad> ranks) {
  if (style_ == Style::silent) return;
  std::string text = progress_text(part, parts, ranks);
  if (style_ == Style::bar) {
    // What is shorter than before leaves nothing of it.
    fmt::print(stderr, "\runderstudy: {:<{}}", text, shown_);
    shown_ = text.size();
    drawn_ = true;
    return;
  }
  text += " (";
  for (const compositor::RankLoad& rank : ranks)
    text += fmt::format("{}{}", text.ends_with('(') ? "" : ", ", rank.bytes_read);
  fmt::print(stderr, "understudy: {} bytes)\n", text);
}

LoadProgress::~LoadProgress() {
  if (drawn_) std::fputc('\n', stderr);
}

}  // namespace understudy::launcher
