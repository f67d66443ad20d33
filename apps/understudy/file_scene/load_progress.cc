// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/load_progress.h"

#include <fmt/format.h>

namespace understudy::launcher {

double share_done(std::span<const compositor::RankLoad> ranks) {
  std::uint64_t done = 0, all = 0;
  for (const compositor::RankLoad& rank : ranks) {
    done += rank.texels_done;
    all += rank.texels_in_all;
  }
  return all == 0 ? 1.0 : double(done) / double(all);
}

std::string progress_text(std::span<const compositor::RankLoad> ranks) {
  constexpr int bar_width = 20;
  std::uint64_t bytes = 0;
  for (const compositor::RankLoad& rank : ranks) bytes += rank.bytes_read;
  const double share = share_done(ranks);
  const auto filled = std::size_t(share * bar_width);
  return fmt::format("loading {:3} % [{:<{}}] {} MiB read by {} {}", int(share * 100), std::string(filled, '#'),
                     bar_width, bytes >> 20U, ranks.size(), ranks.size() == 1 ? "rank" : "ranks");
}

std::string progress_text(int part, int parts, std::span<const compositor::RankLoad> ranks) {
  if (parts == 1) return progress_text(ranks);
  return fmt::format("part {} of {}: {}", part + 1, parts, progress_text(ranks));
}

void show_load(Progress& progress, int part, int parts, std::span<const compositor::RankLoad> ranks) {
  std::string text = progress_text(part, parts, ranks);
  if (progress.style() == ProgressStyle::lines) {
    text += " (";
    for (const compositor::RankLoad& rank : ranks)
      text += fmt::format("{}{}", text.ends_with('(') ? "" : ", ", rank.bytes_read);
    text += " bytes)";
  }
  progress.show((part + share_done(ranks)) / parts, text);
}

}  // namespace understudy::launcher
