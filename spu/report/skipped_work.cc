// SPDX-License-Identifier: Apache-2.0
#include "spu/report/skipped_work.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::spu {
namespace {

Amount& of(Amounts& amounts, Optimization optimization) {
  return amounts[std::size_t(optimization)];
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
  return fmt::format("{:.3g} %", whole == 0 ? 0.0 : 100 * double(part) / double(whole));
}

std::string listed_reasons(const ReasonCounts& reasons) {
  std::string list;
  for (const auto& [reason, count] : reasons)
    list += fmt::format("{}{} ({}x)", list.empty() ? "" : ", ", reason, count);
  return list;
}

/// Why work was done that the optimization could have skipped.
std::string why(Optimization optimization, const volume::FrameCounts& counts, const ReasonCounts& reasons) {
  switch (optimization) {
    case Optimization::empty_bricks:
      return fmt::format("{} of {} blocks show something", counts.blocks - counts.blocks_empty, counts.blocks);
    case Optimization::hidden_samples:
      return fmt::format("{} of {} rays are seen through to their end", counts.rays - counts.rays_terminated,
                         counts.rays);
    case Optimization::dominated_samples:
      return counts.dominated_samples > 0 ? "something larger may be there"
                                          : "no maximum of rising colours was asked for";
    case Optimization::footprints:
      return counts.messages_of_whole_windows == 0
                 ? "one process: nothing travels"
                 : fmt::format(
                       "samples reached these pixels; {} messages, with whole windows {}; {} parts of nodes "
                       "empty",
                       counts.messages, counts.messages_of_whole_windows, counts.nodes_idle);
    default:
      return listed_reasons(reasons);
  }
}

}  // namespace

Amounts amounts_of(const Amounts& in_process, const volume::FrameCounts& counts) {
  Amounts amounts = in_process;
  const std::uint64_t taken = counts.samples_taken;
  const std::uint64_t elsewhere = taken + counts.samples_hidden + counts.dominated_samples;
  of(amounts, Optimization::empty_bricks) = {taken, counts.samples - std::min(counts.samples, elsewhere)};
  of(amounts, Optimization::hidden_samples) = {taken, counts.samples_hidden};
  of(amounts, Optimization::dominated_samples) = {taken, counts.dominated_samples};
  of(amounts, Optimization::footprints) = {
      counts.bytes_exchanged,
      counts.bytes_of_whole_windows - std::min(counts.bytes_of_whole_windows, counts.bytes_exchanged)};
  return amounts;
}

std::string sentence_of(const FrameRecord& frame) {
  const Amounts amounts = amounts_of(frame.amounts, frame.counts);
  std::string text;
  for (std::size_t i = 0; i < optimization_count; ++i) {
    const auto [done, left_out] = amounts[i];
    if (left_out == 0) continue;
    const bool samples = i <= std::size_t(Optimization::dominated_samples);
    const std::uint64_t all = samples ? std::max(frame.counts.samples, done) : done + left_out;
    const OptimizationText& about = optimization_table()[i];
    text += fmt::format("{}{} ({} of {} {})", text.empty() ? "" : ", ", about.name, percent(left_out, all), all,
                        about.unit);
  }
  return text.empty() ? "nothing" : text;
}

std::vector<std::string> lines_about(const Amounts& in_process, const volume::FrameCounts& counts,
                                     const std::array<ReasonCounts, optimization_count>& done_because) {
  const Amounts amounts = amounts_of(in_process, counts);
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < optimization_count; ++i) {
    const OptimizationText& about = optimization_table()[i];
    const auto [done, left_out] = amounts[i];
    if (done + left_out == 0 && i != std::size_t(Optimization::footprints)) {
      lines.push_back(fmt::format("{}: nothing to leave out", about.name));
      continue;
    }
    const bool samples = i <= std::size_t(Optimization::dominated_samples);
    const std::uint64_t all = samples ? std::max(counts.samples, done) : done + left_out;
    lines.push_back(fmt::format("{}: left out {} of {} {} {}", about.name, percent(left_out, all), all,
                                about.unit, about.what));
    const std::string because = why(Optimization(i), counts, done_because[i]);
    if (!because.empty()) lines.back() += fmt::format("; not {}: {}", done, because);
  }
  for (const char* const never :
       {"whether the window can be seen at all: to ask X would cost every frame a round trip",
        "memory of blocks that show nothing: other colours may show them in the next frame"})
    lines.push_back(fmt::format("not looked for: {}", never));
  return lines;
}

}  // namespace understudy::spu
