// SPDX-License-Identifier: Apache-2.0
#include "spu/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "spu/report/keys.h"
#include "spu/report/skipped_work.h"
#include "spu/report/volume_report.h"
#include "volume/frame_counts.h"

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;

/// The volumes without those that were merged into others.
std::vector<const VolumeCounters*> volumes_of(const ProcessCounters& process) {
  const auto count = std::min<std::uint32_t>(process.volumes.load(), max_counted_volumes);
  std::vector<const VolumeCounters*> result;
  for (const VolumeCounters& volume : std::span(process.volume, count)) {
    if (volume.place != VolumePlace::given_up) result.push_back(&volume);
  }
  return result;
}

/// Visits the last `most` frames in the ring, which holds the last max_frame_records, oldest first.
template <typename Visit>
void for_each_kept_frame(const ProcessCounters& process, std::size_t most, Visit visit) {
  const std::uint64_t frames = process.frames.load();
  const std::uint64_t kept = std::min<std::uint64_t>({frames, most, max_frame_records});
  const std::uint64_t first = frames - kept;
  for (std::uint64_t number = first; number < frames; ++number) {
    visit(number, process.frame[number % max_frame_records]);
  }
}

std::uint64_t calls_of(const ProcessCounters& process) {
  std::uint64_t calls = 0;
  for (const std::uint64_t& slot : process.calls) calls += slot;
  return calls;
}

bool did_something(const ProcessCounters& process) {
  return process.frames.load() > 0 || process.volumes.load() > 0 || calls_of(process) > 0;
}

Json median(std::vector<double> values) {
  if (values.empty()) return nullptr;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

Json median_times(Processes processes) {
  std::vector<double> all;
  std::vector<double> substituted;
  std::vector<double> application;
  std::vector<double> waiting;
  std::vector<double> recognition;
  std::vector<double> depth;
  std::vector<double> budget;
  for (const ProcessCounters* process : processes) {
    for_each_kept_frame(*process, max_frame_records, [&](std::uint64_t, const FrameRecord& frame) {
      all.push_back(frame.time_ms);
      if (frame.substituted > 0) {
        substituted.push_back(frame.time_ms);
        waiting.push_back(frame.spent_ms.waiting);
        recognition.push_back(frame.spent_ms.recognition);
        depth.push_back(frame.spent_ms.depth);
        budget.push_back(frame.spent_ms.budget);
      }
      if (frame.substituted == 0 && frame.left > 0) application.push_back(frame.time_ms);
    });
  }
  return {{report_key::frame_median, median(std::move(all))},
          {report_key::substituted_median, median(std::move(substituted))},
          {report_key::application_median, median(std::move(application))},
          {report_key::waiting_median, median(std::move(waiting))},
          {report_key::recognition_median, median(std::move(recognition))},
          {report_key::depth_median, median(std::move(depth))},
          {report_key::budget_median, median(std::move(budget))}};
}

Json left_out(const volume::FrameCounts& counts, Json items) {
  return {{report_key::samples_skipped, counts.samples - std::min(counts.samples, counts.samples_taken)},
          {report_key::rays_ended_early, counts.rays_terminated},
          {report_key::blocks_empty, counts.blocks_empty},
          {report_key::nodes_idle, counts.nodes_idle},
          {report_key::items, std::move(items)}};
}

Json items_of(const FrameRecord& frame) {
  const Amounts amounts = amounts_of(frame.amounts, frame.counts);
  Json items;
  for (std::size_t i = 0; i < optimization_count; ++i)
    items[optimization_table()[i].name] = amounts[i].left_out;
  return items;
}

Json exchanged(const volume::FrameCounts& counts) {
  return {{report_key::bytes, counts.bytes_exchanged},
          {report_key::messages, counts.messages},
          {report_key::bytes_of_whole_windows, counts.bytes_of_whole_windows},
          {report_key::messages_of_whole_windows, counts.messages_of_whole_windows}};
}

const char* setting_of(const FrameRecord& frame) {
  if (frame.substituted == 0) return "the application";
  return frame.within_budget > 0 ? "samples within the budget" : "the application's planes";
}

Json detail_of(std::uint64_t number, std::int32_t pid, const FrameRecord& frame) {
  Json detail{{report_key::frame, number},
              {report_key::pid, pid},
              {report_key::time, frame.time_ms},
              {report_key::waiting_time, frame.spent_ms.waiting},
              {report_key::recognition_time, frame.spent_ms.recognition},
              {report_key::depth_time, frame.spent_ms.depth},
              {report_key::upload_time, frame.spent_ms.upload},
              {report_key::render_time, frame.spent_ms.render},
              {report_key::verification_time, frame.spent_ms.verification},
              {report_key::presentation_time, frame.spent_ms.presentation},
              {report_key::budget_time, frame.spent_ms.budget},
              {report_key::setting, setting_of(frame)},
              {report_key::substituted, frame.substituted},
              {report_key::left, frame.left},
              {report_key::error_rms, nullptr},
              {report_key::left_out, left_out(frame.counts, items_of(frame))},
              {report_key::exchanged, exchanged(frame.counts)}};
  if (frame.error_rms >= 0) detail[report_key::error_rms] = frame.error_rms;
  return detail;
}

struct Totals {
  std::uint64_t frames = 0;
  std::uint64_t frames_substituted = 0;
  std::uint64_t frames_left = 0;
  std::int32_t nodes = 0;
  std::uint64_t images_behind = 0;
  std::uint64_t windows_asked = 0;
  std::size_t volumes = 0;
  std::uint64_t draws_substituted = 0;  ///< of all volumes, including frames that did not end
  std::uint64_t draws_left = 0;
  volume::FrameCounts counts;
  Amounts amounts{};
  std::array<ReasonCounts, optimization_count> done_because;
  ReasonCounts reasons;
  std::vector<std::string> budgets;  ///< one line for each volume with a budget
};

Totals totals_of(Processes processes) {
  Totals totals;
  for (const ProcessCounters* process : processes) {
    totals.frames += process->frames.load();
    totals.frames_substituted += process->frames_substituted.load();
    totals.frames_left += process->frames_left.load();
    // Not a sum: all processes of a run share one node group.
    totals.nodes = std::max(totals.nodes, process->nodes);
    totals.images_behind += process->images_behind.load();
    totals.windows_asked += process->windows_asked.load();
    totals.counts += process->total;
    totals.amounts += process->total_amounts;
    for (std::size_t i = 0; i < optimization_count; ++i)
      for (const auto& [reason, count] : counts_in(process->done_because[i]))
        totals.done_because[i][reason] += count;
    for (const VolumeCounters* const entry : volumes_of(*process)) {
      const VolumeCounters& volume = *entry;
      ++totals.volumes;
      totals.draws_substituted += volume.draws_substituted.load();
      totals.draws_left += volume.draws_left.load();
      for (const auto& [reason, count] : reasons_of(volume)) totals.reasons[reason] += count;
      if (has_budget(volume.budget))
        totals.budgets.push_back(
            fmt::format("volume of texture {}: {}", volume.texture, sentence_of(volume.budget)));
    }
  }
  return totals;
}

Json items_of(const Totals& totals) {
  const Amounts amounts = amounts_of(totals.amounts, totals.counts);
  Json items;
  for (std::size_t i = 0; i < optimization_count; ++i) {
    const OptimizationText& about = optimization_table()[i];
    items[about.name] = {{report_key::unit, about.unit},
                         {report_key::left_out, amounts[i].left_out},
                         {report_key::done, amounts[i].done},
                         {report_key::because, Json(totals.done_because[i])}};
  }
  return items;
}

bool is_remote(Processes processes) {
  return std::any_of(processes.begin(), processes.end(),
                     [](const ProcessCounters* process) { return process->remote.is.load() != 0; });
}

std::uint64_t frames_from_a_gl_server(Processes processes) {
  std::uint64_t frames = 0;
  for (const ProcessCounters* process : processes) frames += process->remote.frames.load();
  return frames;
}

/// Whether the processes include a GL server, which counts the calls that it plays.
bool has_a_gl_server(Processes processes) {
  return std::any_of(processes.begin(), processes.end(), [](const ProcessCounters* process) {
    return process->remote.is.load() == 0 && calls_of(*process) > 0;
  });
}

bool only_a_stage_elsewhere_knows(Processes processes) {
  return frames_from_a_gl_server(processes) > 0 && totals_of(processes).frames == 0 &&
         !has_a_gl_server(processes);
}

std::uint64_t frames_lost(Processes processes) {
  std::uint64_t frames = 0;
  for (const ProcessCounters* process : processes) frames += process->remote.frames_lost.load();
  return frames;
}

Json server_connection(Processes processes) {
  if (!is_remote(processes)) return nullptr;
  const std::uint64_t frames = frames_from_a_gl_server(processes);
  std::uint64_t round_trips = 0;
  std::uint64_t up = 0;
  std::uint64_t down = 0;
  for (const ProcessCounters* process : processes) {
    round_trips += process->remote.round_trips.load();
    up += process->remote.bytes_up.load();
    down += process->remote.bytes_down.load();
  }
  const auto a_frame = [&](std::uint64_t sum) {
    return frames == 0 ? Json() : Json(double(sum) / double(frames));
  };
  return {{report_key::frames, frames},
          {report_key::round_trips, round_trips},
          {report_key::bytes_up, up},
          {report_key::bytes_down, down},
          {report_key::lost, lost_server(processes)},
          {report_key::frames_lost, frames_lost(processes)},
          {report_key::per_frame,
           {{report_key::round_trips, a_frame(round_trips)},
            {report_key::bytes_up, a_frame(up)},
            {report_key::bytes_down, a_frame(down)}}}};
}

/// The tiles of the first GL server that has drawn in tiles.
Json tiles(Processes processes) {
  const auto found = std::find_if(processes.begin(), processes.end(), [](const ProcessCounters* process) {
    return process->tiles.count > 0 || process->tiles.given_up[0] != 0;
  });
  if (found == processes.end()) return nullptr;
  const TileCounters& counted = (*found)->tiles;
  return {{report_key::of, counted.count},
          {report_key::frames, counted.frames.load()},
          {report_key::given_up, std::string(counted.given_up)}};
}

std::string counted(std::uint64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// Appended to the summary: frames that were never shown; empty if none is missing.
std::string loss(Processes processes) {
  if (!lost_server(processes)) return {};
  return fmt::format("; the GL server was lost: {} not shown", counted(frames_lost(processes), "frame"));
}

std::string listed(const ReasonCounts& reasons) {
  std::string list;
  for (const auto& [reason, count] : reasons) {
    list +=
        fmt::format("{}{}{}", list.empty() ? "" : "; ", reason, count > 1 ? fmt::format(" ({}x)", count) : "");
  }
  return list;
}

/// Empty if the volume was refused before its texture was inspected.
std::string extent_and_format(const VolumeCounters& volume) {
  if (volume.size[0] == 0) return {};
  return fmt::format(", {} x {} x {} {}", volume.size[0], volume.size[1], volume.size[2],
                     text_in(volume.texture_format));
}

}  // namespace

bool lost_server(Processes processes) {
  return std::any_of(processes.begin(), processes.end(),
                     [](const ProcessCounters* process) { return process->remote.lost.load() != 0; });
}

std::optional<bool> has_substituted(Processes processes) {
  if (only_a_stage_elsewhere_knows(processes)) return {};
  const Totals totals = totals_of(processes);
  return totals.frames_substituted > 0 || totals.draws_substituted > 0;
}

std::string report_json(Processes processes, std::size_t most_frames) {
  const Totals totals = totals_of(processes);
  Json report{{report_key::frames, totals.frames},
              {report_key::frames_substituted, totals.frames_substituted},
              {report_key::frames_left, totals.frames_left},
              {report_key::nodes, totals.nodes},
              {report_key::remote, is_remote(processes)},
              {report_key::server_connection, server_connection(processes)},
              {report_key::tiles, tiles(processes)},
              {report_key::images_behind, totals.images_behind},
              {report_key::windows_asked, totals.windows_asked},
              {report_key::processes, Json::array()},
              {report_key::time_ms, median_times(processes)},
              {report_key::left_out, left_out(totals.counts, items_of(totals))},
              {report_key::exchanged, exchanged(totals.counts)},
              {report_key::volumes, Json::array()},
              {report_key::frames_detail, Json::array()}};
  for (const ProcessCounters* process : processes) {
    if (!did_something(*process)) continue;
    report[report_key::processes].push_back({{report_key::pid, process->pid},
                                             {report_key::program, text_in(process->program)},
                                             {report_key::calls, calls_of(*process)}});
    for (const VolumeCounters* const entry : volumes_of(*process)) {
      const VolumeCounters& volume = *entry;
      report[report_key::volumes].push_back(report_of(volume, process->pid));
    }
    for_each_kept_frame(*process, most_frames, [&](std::uint64_t number, const FrameRecord& frame) {
      report[report_key::frames_detail].push_back(detail_of(number, process->pid, frame));
    });
  }
  // Names come from other programs' memory: invalid UTF-8 is replaced instead of causing an exception.
  return report.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string summary_line(Processes processes) {
  if (only_a_stage_elsewhere_knows(processes))
    return fmt::format(
               "understudy: {} came from a GL server on another machine, which knows what of them was "
               "substituted",
               counted(frames_from_a_gl_server(processes), "frame")) +
           loss(processes);
  const Totals totals = totals_of(processes);
  // ParaView's scripts draw into a widget's framebuffer object and exit before Qt shows it: no frame ends.
  const std::uint64_t draws = totals.draws_substituted + totals.draws_left;
  const bool shown = totals.frames > 0 || draws == 0;
  const std::uint64_t substituted = shown ? totals.frames_substituted : totals.draws_substituted;
  // It is known who draws once something was drawn.
  std::string where;
  if (totals.nodes > 0) {
    where = fmt::format(" ({})", counted(static_cast<std::uint64_t>(totals.nodes), "node"));
  } else if (substituted > 0) {
    where = " (embedded)";
  }
  std::string line = fmt::format(
      "understudy: {} seen, {}: {} substituted{}, {} not substituted", counted(totals.volumes, "volume"),
      shown ? counted(totals.frames, "frame") : "no frame shown, " + counted(draws, "draw"), substituted, where,
      shown ? totals.frames_left : totals.draws_left);
  if (!totals.reasons.empty()) line += ": " + listed(totals.reasons);
  line += loss(processes);
  for (const std::string& budget : totals.budgets) line += "\nunderstudy: " + budget;
  return line;
}

std::string explanation_text(Processes processes) {
  std::string text;
  for (const ProcessCounters* process : processes) {
    if (!did_something(*process)) continue;
    text += fmt::format("understudy: process {} ({}): {}, {}\n", process->pid, text_in(process->program),
                        counted(calls_of(*process), "OpenGL call"), counted(process->frames.load(), "frame"));
    for (const VolumeCounters* const entry : volumes_of(*process)) {
      const VolumeCounters& volume = *entry;
      text += fmt::format("understudy:   texture {}{}: {} of slices substituted, {} left\n", volume.texture,
                          extent_and_format(volume), counted(volume.draws_substituted.load(), "run"),
                          volume.draws_left.load());
      if (volume.explanation[0] != '\0') {
        text += fmt::format("understudy:     recognised: {}\n", text_in(volume.explanation));
      }
      if (const std::uint64_t sent = volume.texel_bytes_sent.load(); sent > 0) {
        text += fmt::format("understudy:     texels: {} bytes sent, {} bytes left out\n", sent,
                            volume.texel_bytes_left_out.load());
      }
      for (const auto& [reason, count] : reasons_of(volume)) {
        text += fmt::format("understudy:     not substituted {}x: {}\n", count, reason);
      }
      if (const std::uint64_t frames = volume.verified_frames.load(); frames > 0) {
        text += fmt::format(
            "understudy:     verified on {}: max {:.4g}, RMS {:.4g}, worst tile {:.2f} of the bound (frame "
            "{})\n",
            counted(frames, "frame"), volume.verify_max, verified_rms(volume), volume.verify_worst_tile,
            volume.verify_worst_frame);
      }
    }
  }
  const Totals totals = totals_of(processes);
  if (totals.frames_substituted > 0) {
    for (const std::string& line : lines_about(totals.amounts, totals.counts, totals.done_because))
      text += fmt::format("understudy: {}\n", line);
  }
  return text;
}

}  // namespace understudy::spu
