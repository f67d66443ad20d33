// SPDX-License-Identifier: Apache-2.0
// The file to which all contexts of a process are recorded.
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
  /// If `file` already exists, it belongs to another process of the same run, and this process uses `file`.PID.
  /// Nothing is written before the first block.
  explicit Recording(std::string file) : file_(std::move(file)) {}

  /// Calls `append`, which adds records of this thread, by one thread at a time. Adds a `thread` event before
  /// them if the previous records came from another thread.
  template <class Append>
  void append(const Append& append) {
    const std::scoped_lock lock(mutex_);
    name_thread();
    append(records_);
  }

  /// A frame ends: blocks end with frames, so that a truncated file still ends with a complete frame.
  void end_frame(std::uint64_t width, std::uint64_t height);
  /// Writes the records so far if there are many, or if `now`.
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
