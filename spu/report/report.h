// SPDX-License-Identifier: Apache-2.0
// What one run did, read from the counters of its processes: the JSON report, the summary line, the
// explanation.
//
// The launcher reads the counters of every process of the run after their end (read_counters). A process that
// was started with plain LD_PRELOAD writes a report about itself (write_report_now). Times in milliseconds,
// colour errors on the scale of 0 to 1.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/report/counters.h"

namespace understudy::spu {

/// Counters that are mapped from a file, read-only.
struct UnmapCounters {
  void operator()(const ProcessCounters* counters) const;
};
using MappedCounters = std::unique_ptr<const ProcessCounters, UnmapCounters>;

constexpr std::size_t max_counted_processes = 4096;  ///< of one run; later ones are not in the report

/// The counters of all processes that left a file in the launcher's folder, by process id. Files that are not
/// counters (too short, another version) are passed over.
std::vector<MappedCounters> read_counters(const std::filesystem::path& folder);

/// How many processes could not keep their figures in the launcher's folder: they have left an empty file.
std::size_t processes_without_figures(const std::filesystem::path& folder);

using Processes = std::span<const ProcessCounters* const>;

/// Whether the GL server of one of them went away.
bool lost_server(Processes processes);

/// Whether anything was substituted, in a frame that was shown or in none; nothing where only a GL server on
/// another machine knows.
std::optional<bool> has_substituted(Processes processes);

/// The report as JSON, indented, with a closing newline. Processes that neither drew nor called OpenGL are left
/// out.
std::string report_json(Processes processes);

/// "understudy: 1 volume, 20 frames: 19 substituted (4 nodes), 1 not substituted (reason, …)".
std::string summary_line(Processes processes);

/// Several lines: for every volume what was recognised, how its draws were treated, and why some were left.
std::string explanation_text(Processes processes);

/// Writes `text` beside `path` and renames it there: readers see the old file or the new one, never a part.
/// Throws std::runtime_error with the path and the reason.
void replace_file(const std::filesystem::path& path, const std::string& text);

/// Replaces `path` by a report about this process. False when that failed; said once on stderr.
bool write_report_now(const std::string& path) noexcept;

/// The same, for a call at every frame's end: most calls do nothing, so that writing stays below 2 % of the run
/// time. What the last half second brought may be missing from the file; write_report_now at the library's end
/// adds it.
void write_report_when_due(const std::string& path) noexcept;

}  // namespace understudy::spu
