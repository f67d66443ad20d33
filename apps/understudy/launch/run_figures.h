// SPDX-License-Identifier: Apache-2.0
// What the processes of a run have counted, once they have ended.
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
  /// Of the processes that counted in `folder`.
  explicit RunFigures(const std::filesystem::path& folder);

  spu::Processes processes() const { return processes_; }
  /// Whether any process of the viewer ended a frame.
  bool saw_frames() const;
  /// The summary, and which figures are missing in it.
  std::string summary() const;
  /// The exit status of a run in which frames had to be substituted; `viewer`, the viewer's own, where that
  /// tells of a failure.
  int required_status(int viewer) const;

 private:
  std::string folder_;
  std::vector<spu::MappedCounters> counters_;
  std::vector<const spu::ProcessCounters*> processes_;
  std::size_t without_ = 0;  ///< processes that could not keep theirs
};

}  // namespace understudy::launcher
