// SPDX-License-Identifier: Apache-2.0
// Sums the figures of a process's contexts and writes them. A file is rewritten regularly, because a viewer may
// end without notice.
#pragma once

#include <chrono>
#include <list>
#include <mutex>
#include <string>

#include "spu/perf/figures.h"

namespace understudy::spu {

class PerfFile {
 public:
  /// An empty name means standard error, which gets its table only at the end.
  explicit PerfFile(std::string name) : name_(std::move(name)) {}

  Figures& begin_context();
  /// Adds the context's figures to those of ended contexts, and writes the table.
  void end_context(const Figures& figures);

  /// Writes at most every half second, and only to a file.
  void write_when_due();
  void write();

 private:
  void write_locked();

  const std::string name_;
  std::mutex mutex_;
  Figures ended_;
  std::list<Figures> contexts_;
  std::uint64_t calls_told_ = 0;
  bool failure_told_ = false;
  std::chrono::steady_clock::time_point due_{};
};

}  // namespace understudy::spu
