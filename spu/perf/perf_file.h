// SPDX-License-Identifier: Apache-2.0
// Where the figures of a process's contexts come together and are told: nobody promises that a viewer ends in
// order, so a file is written again and again.
#pragma once

#include <chrono>
#include <list>
#include <mutex>
#include <string>

#include "spu/perf/figures.h"

namespace understudy::spu {

class PerfFile {
 public:
  /// An empty name stands for the standard error output, which gets its table at the end only.
  explicit PerfFile(std::string name) : name_(std::move(name)) {}

  Figures& begin_context();
  /// Its figures stay counted; the table is written.
  void end_context(const Figures& figures);

  /// At most every half second; nothing without a file.
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
