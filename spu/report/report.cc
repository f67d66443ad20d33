// SPDX-License-Identifier: Apache-2.0
#include "spu/report/report.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "compositor/logging/log.h"
#include "spu/report/keys.h"
#include "spu/report/skipped_work.h"
#include "volume/frame_counts.h"

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;
/// A fixed field that a dying process may have left without its closing zero.
template <std::size_t size>
std::string text_in(const char (&field)[size]) {
  return {field, strnlen(field, size)};
}

/// Those that are volumes still: bricks that have become one with others are not.
std::vector<const VolumeCounters*> volumes_of(const ProcessCounters& process) {
  const auto count = std::min<std::uint32_t>(process.volumes.load(), max_counted_volumes);
  std::vector<const VolumeCounters*> result;
  for (const VolumeCounters& volume : std::span(process.volume, count)) {
    if (volume.place != VolumePlace::given_up) result.push_back(&volume);
  }
  return result;
}

/// Oldest first; the ring holds the last max_frame_records frames.
template <typename Visit>
void for_each_kept_frame(const ProcessCounters& process, Visit visit) {
  const std::uint64_t frames = process.frames.load();
  const std::uint64_t first = frames > max_frame_records ? frames - max_frame_records : 0;
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

ReasonCounts counts_in(std::span<const ReasonCount> counted) {
  ReasonCounts reasons;
  for (const ReasonCount& reason : counted) {
    if (const std::uint64_t count = reason.count.load(); count > 0) reasons[text_in(reason.reason)] += count;
  }
  return reasons;
}

ReasonCounts reasons_of(const VolumeCounters& volume) {
  return counts_in(volume.left_because);
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
  std::vector<double> recognition;
  std::vector<double> depth;
  std::vector<double> budget;
  for (const ProcessCounters* process : processes) {
    for_each_kept_frame(*process, [&](std::uint64_t, const FrameRecord& frame) {
      all.push_back(frame.time_ms);
      if (frame.substituted > 0) {
        substituted.push_back(frame.time_ms);
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

double verified_rms(const VolumeCounters& volume) {
  const auto frames = static_cast<double>(volume.verified_frames.load());
  return frames > 0 ? std::sqrt(volume.verify_sum_sq / frames) : 0;
}

Json verified(const VolumeCounters& volume) {
  const std::uint64_t frames = volume.verified_frames.load();
  const std::uint64_t tiles = volume.verified_tiles.load();
  Json json{{report_key::frames, frames},
            {report_key::tiles, tiles},
            {report_key::lost, volume.verify_lost.load()},
            {report_key::worst_tile, nullptr},
            {report_key::worst_frame, nullptr},
            {report_key::max, nullptr},
            {report_key::rms, nullptr},
            {report_key::psnr, nullptr}};
  if (frames + tiles > 0) {
    json[report_key::worst_tile] = volume.verify_worst_tile;
    json[report_key::worst_frame] = volume.verify_worst_frame;
  }
  if (frames > 0) {
    const double rms = verified_rms(volume);
    json[report_key::max] = volume.verify_max;
    json[report_key::rms] = rms;
    if (rms > 0) json[report_key::psnr] = -20 * std::log10(rms);
  }
  return json;
}

bool has_budget(const BudgetCounters& budget) {
  return budget.asked_error > 0 || budget.asked_ms > 0;
}

Json report_of(const BudgetCounters& budget) {
  if (!has_budget(budget)) return nullptr;
  const auto or_null = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  return {{report_key::asked, or_null(budget.asked_error)},
          {report_key::asked_ms, or_null(budget.asked_ms)},
          {report_key::measured, budget.calibrations > 0 ? Json(budget.measured) : Json(nullptr)},
          {report_key::time, or_null(budget.ms)},
          {report_key::setting, text_in(budget.setting)},
          {report_key::rays_integrated, budget.rays},
          {report_key::images_over, budget.images_over},
          {report_key::calibrations, budget.calibrations},
          {report_key::note, text_in(budget.note)}};
}

/// "error asked 0.0020, measured 0.0013", and how, or why not.
std::string sentence_of(const BudgetCounters& budget) {
  std::string asked;
  if (budget.asked_error > 0) {
    asked = fmt::format("error asked {:.4f}", budget.asked_error);
  } else {
    asked = fmt::format("time asked {:.4g} ms, taken {:.4g} ms", budget.asked_ms, budget.ms);
  }
  if (budget.calibrations > 0)
    asked += fmt::format(", {} {:.4f} ({:.3g} ms an image, {})",
                         budget.asked_error > 0 ? "measured" : "error measured", budget.measured, budget.ms,
                         text_in(budget.setting));
  if (budget.note[0] != '\0') asked += "; " + text_in(budget.note);
  return asked;
}

Json report_of(const VolumeCounters& volume, std::int32_t pid) {
  Json because = Json::object();
  for (const auto& [reason, count] : reasons_of(volume)) because[reason] = count;
  return {{report_key::pid, pid},
          {report_key::texture, volume.texture},
          {report_key::size, volume.size},
          {report_key::texture_format, text_in(volume.texture_format)},
          {report_key::draws,
           {{report_key::substituted, volume.draws_substituted.load()},
            {report_key::left, volume.draws_left.load()}}},
          {report_key::probes, volume.probes.load()},
          {report_key::texels,
           {{report_key::bytes_sent, volume.texel_bytes_sent.load()},
            {report_key::bytes_left_out, volume.texel_bytes_left_out.load()}}},
          {report_key::left_because, because},
          {report_key::verify, verified(volume)},
          {report_key::budget, report_of(volume.budget)},
          {report_key::explanation, text_in(volume.explanation)}};
}

struct Totals {
  std::uint64_t frames = 0;
  std::uint64_t frames_substituted = 0;
  std::uint64_t frames_left = 0;
  std::int32_t nodes = 0;
  std::uint64_t images_behind = 0;
  std::uint64_t windows_asked = 0;
  std::size_t volumes = 0;
  volume::FrameCounts counts;
  Amounts amounts{};
  std::array<ReasonCounts, optimization_count> done_because;
  ReasonCounts reasons;
  std::vector<std::string> budgets;  ///< of each volume that has one
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

/// A GL server of this run is one of its processes, and counts the calls that it plays.
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

/// Of the first GL server that has drawn in tiles.
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

/// What of the windows was never shown, behind the summary; empty where nothing is missing.
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

}  // namespace

void UnmapCounters::operator()(const ProcessCounters* counters) const {
  munmap(const_cast<ProcessCounters*>(counters), sizeof(ProcessCounters));
}

std::vector<MappedCounters> read_counters(const std::filesystem::path& folder) {
  std::vector<MappedCounters> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".counters" || found.size() >= max_counted_processes) continue;
    const int file = open(entry.path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) continue;
    struct stat status {};
    void* mapped = MAP_FAILED;
    if (fstat(file, &status) == 0 && S_ISREG(status.st_mode) &&
        status.st_size >= static_cast<off_t>(sizeof(ProcessCounters))) {
      mapped = mmap(nullptr, sizeof(ProcessCounters), PROT_READ, MAP_SHARED, file, 0);
    }
    close(file);
    if (mapped == MAP_FAILED) continue;
    MappedCounters counters(static_cast<const ProcessCounters*>(mapped));
    if (counters->magic == counters_magic) found.push_back(std::move(counters));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a->pid < b->pid; });
  return found;
}

std::size_t processes_without_figures(const std::filesystem::path& folder) {
  std::size_t count = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    count +=
        entry.path().extension() == ".counters" && entry.is_regular_file(error) && entry.file_size(error) == 0;
  return count;
}

bool lost_server(Processes processes) {
  return std::any_of(processes.begin(), processes.end(),
                     [](const ProcessCounters* process) { return process->remote.lost.load() != 0; });
}

std::optional<bool> has_substituted(Processes processes) {
  if (only_a_stage_elsewhere_knows(processes)) return {};
  return totals_of(processes).frames_substituted > 0;
}

std::string report_json(Processes processes) {
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
    for_each_kept_frame(*process, [&](std::uint64_t number, const FrameRecord& frame) {
      report[report_key::frames_detail].push_back(detail_of(number, process->pid, frame));
    });
  }
  // Names come from other programs' memory: bytes that are no UTF-8 are replaced, never thrown at.
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
  // Who draws is known once somebody did.
  std::string where;
  if (totals.nodes > 0) {
    where = fmt::format(" ({})", counted(static_cast<std::uint64_t>(totals.nodes), "node"));
  } else if (totals.frames_substituted > 0) {
    where = " (embedded)";
  }
  std::string line = fmt::format("understudy: {} seen, {}: {} substituted{}, {} not substituted",
                                 counted(totals.volumes, "volume"), counted(totals.frames, "frame"),
                                 totals.frames_substituted, where, totals.frames_left);
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
      text += fmt::format("understudy:   texture {}, {} x {} x {} {}: {} of slices substituted, {} left\n",
                          volume.texture, volume.size[0], volume.size[1], volume.size[2],
                          text_in(volume.texture_format), counted(volume.draws_substituted.load(), "run"),
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

void replace_file(const std::filesystem::path& path, const std::string& text) {
  const auto fail = [&](const char* what) {
    throw std::runtime_error(
        fmt::format("cannot {} the report {}: {}", what, path.string(), std::strerror(errno)));
  };
  // A report may be wanted where others can write: a name that they cannot guess, and no connection of theirs.
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != ssize_t(sizeof random)) fail("name");
  const std::string beside = fmt::format("{}.{:016x}.part", path.string(), random);
  std::FILE* file = std::fopen(beside.c_str(), "wxe");
  if (file == nullptr) fail("write");
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed || std::rename(beside.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    std::remove(beside.c_str());
    errno = reason;
    fail("finish");
  }
}

bool write_report_now(const std::string& path) noexcept {
  static std::atomic<bool> complained = false;
  try {
    const ProcessCounters* const self = &process_counters();
    replace_file(path, report_json(Processes(&self, 1)));
    return true;
  } catch (const std::exception& error) {
    if (!complained.exchange(true)) logging::write(logging::Level::error, error.what());
    return false;
  }
}

void write_report_when_due(const std::string& path) noexcept {
  using Clock = std::chrono::steady_clock;
  constexpr int share = 50;  // one part writing in 50 parts of run time
  constexpr std::chrono::milliseconds soonest(500);
  static std::atomic<Clock::rep> due = 0;
  const Clock::time_point start = Clock::now();
  Clock::rep expected = due.load();
  if (start.time_since_epoch().count() < expected) return;
  // One thread writes; the others pass.
  if (!due.compare_exchange_strong(expected, (start + std::chrono::hours(1)).time_since_epoch().count()))
    return;
  write_report_now(path);
  const Clock::duration cost = Clock::now() - start;
  due = (Clock::now() + std::max<Clock::duration>(soonest, share * cost)).time_since_epoch().count();
}

}  // namespace understudy::spu
