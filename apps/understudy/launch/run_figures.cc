// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/run_figures.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::launcher {

RunFigures::RunFigures(const std::filesystem::path& folder)
    : folder_(folder), counters_(spu::read_counters(folder)), without_(spu::processes_without_figures(folder)) {
  processes_.reserve(counters_.size());
  for (const spu::MappedCounters& process : counters_) processes_.push_back(process.get());
}

bool RunFigures::saw_frames() const {
  return std::ranges::any_of(processes_,
                             [](const spu::ProcessCounters* process) { return process->frames > 0; });
}

std::string RunFigures::summary() const {
  if (without_ == 0) return spu::summary_line(processes_);
  const std::string missing = fmt::format(
      "understudy: the figures of {} {} could not be written to {}, so it is not known what was substituted; "
      "free disk space there",
      without_, without_ == 1 ? "process" : "processes", folder_);
  return processes_.empty() ? missing : spu::summary_line(processes_) + "\n" + missing;
}

int RunFigures::required_status(int viewer) const {
  if (viewer != 0) return viewer;
  if (spu::lost_server(processes_)) return server_lost;
  return spu::has_substituted(processes_).value_or(true) ? 0 : nothing_substituted;
}

}  // namespace understudy::launcher
