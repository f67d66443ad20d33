// SPDX-License-Identifier: Apache-2.0
// What one run did, read from the counters of its processes: the JSON report, the summary line and the
// explanation.
//
// The launcher reads the counters of all processes of the run after they have ended (read_counters). A process
// that was started with plain LD_PRELOAD writes a report about itself (write_report_now). Times are in
// milliseconds, colour errors on a scale from 0 to 1.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/report/counters.h"

namespace understudy::spu {

/// Unmaps counters that were mapped read-only from a file.
struct UnmapCounters {
  void operator()(const ProcessCounters* counters) const;
};
using MappedCounters = std::unique_ptr<const ProcessCounters, UnmapCounters>;

constexpr std::size_t max_counted_processes = 4096;  ///< of one run; further ones are not in the report

/// The counters of all processes that left a file in the launcher's folder, by process id. Files that are not
/// counters (too short, another version) are ignored.
std::vector<MappedCounters> read_counters(const std::filesystem::path& folder);

/// The number of processes that could not keep their figures in the launcher's folder and left an empty file.
std::size_t processes_without_figures(const std::filesystem::path& folder);

using Processes = std::span<const ProcessCounters* const>;

/// Whether a process has lost its GL server.
bool lost_server(Processes processes);

/// Whether anything was substituted, in a frame that was shown or outside one; nothing if only a GL server on
/// another machine has that information.
std::optional<bool> has_substituted(Processes processes);

/// The report as indented JSON with a closing newline, with the last `most_frames` frames of each process.
/// Processes that neither drew nor called OpenGL are omitted.
std::string report_json(Processes processes, std::size_t most_frames = max_frame_records);

/// The same about this process while it runs, for any thread. Figures that change in the meantime may belong to
/// two frames.
std::string running_report_json(std::size_t most_frames);

/// "understudy: 1 volume, 20 frames: 19 substituted (4 nodes), 1 not substituted (reason, …)".
std::string summary_line(Processes processes);

/// Several lines: for every volume what was recognised, how its draws were treated, and why some were not
/// substituted.
std::string explanation_text(Processes processes);

/// Writes `text` to a file beside `path` and renames that to `path`: readers see the old or the new file, never
/// a part. Throws std::runtime_error with the path and the reason.
void replace_file(const std::filesystem::path& named, const std::string& text);

/// Replaces `path` by a report about this process. Returns false if that failed, which is logged once.
bool write_report_now(const std::string& path) noexcept;

/// The same, to be called at the end of every frame: most calls do nothing, so that writing takes less than 2 %
/// of the run time. The last half second may be missing from the file; write_report_now at the library's end
/// adds it.
void write_report_when_due(const std::string& path) noexcept;

}  // namespace understudy::spu
