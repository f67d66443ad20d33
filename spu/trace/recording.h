// SPDX-License-Identifier: Apache-2.0
// The file that all contexts of a process record into.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "spu/stream/trace_file.h"

namespace understudy::spu {

class Recording {
 public:
  /// Where `file` exists already, another process of the same run has it: this one takes `file`.PID. Nothing is
  /// written before the first block.
  explicit Recording(std::string file) : file_(std::move(file)) {}

  /// What follows from this thread goes behind a `thread` event when another thread came last. `append` adds
  /// records; one thread at a time.
  template <class Append>
  void append(const Append& append) {
    const std::scoped_lock lock(mutex_);
    name_thread();
    append(records_);
  }

  /// A frame ends: blocks end with frames, so that what is cut off later still ends with a whole one.
  void end_frame(std::uint64_t width, std::uint64_t height);
  /// Writes what there is, when there is much of it or `now`.
  void flush(bool now);

  std::uint64_t next_context() { return ++contexts_; }

 private:
  void name_thread();
  void write();

  const std::string file_;
  std::mutex mutex_;
  std::unique_ptr<TraceWriter> writer_;
  Records records_;
  std::uint32_t frames_in_block_ = 0;
  std::uint64_t frames_ = 0;
  std::uint64_t contexts_ = 0;
  std::uint64_t last_thread_ = ~std::uint64_t(0);
  int process_ = 0;
  bool failed_ = false;
};

}  // namespace understudy::spu
