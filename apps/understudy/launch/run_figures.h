// SPDX-License-Identifier: Apache-2.0
// The counters of a run's processes, once they have ended.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "spu/report/report.h"

namespace understudy::launcher {

constexpr int nothing_substituted = 3;
constexpr int server_lost = 4;

class RunFigures {
 public:
  /// Reads the counters of the processes in `folder`.
  explicit RunFigures(const std::filesystem::path& folder);

  spu::Processes processes() const { return processes_; }
  /// Returns whether any process of the viewer ended a frame.
  bool saw_frames() const;
  /// Returns the summary, including which figures are missing.
  std::string summary() const;
  /// Returns the exit status of a run that requires substituted frames; the viewer's own status,
  /// `viewer`, if that is a failure.
  int required_status(int viewer) const;

 private:
  std::string folder_;
  std::vector<spu::MappedCounters> counters_;
  std::vector<const spu::ProcessCounters*> processes_;
  std::size_t without_ = 0;  ///< number of processes that could not store their counters
};

}  // namespace understudy::launcher
