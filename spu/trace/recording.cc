// SPDX-License-Identifier: Apache-2.0
#include "spu/trace/recording.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <system_error>

#include "compositor/logging/log.h"
#include "spu/stream/event.h"

namespace understudy::spu {
namespace {

/// Blocks are written at the ends of frames; larger frames are split.
constexpr std::size_t large_block_words = std::size_t(8) << 20;

std::uint64_t recorded_thread() {
  static constinit std::atomic<std::uint64_t> threads{0};
  thread_local const std::uint64_t number = threads.fetch_add(1, std::memory_order_relaxed);
  return number;
}

/// Creates the file for this process, and returns its name.
std::string claim(const std::string& file) {
  const int created = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (created >= 0) {
    ::close(created);
    return file;
  }
  const std::string other = fmt::format("{}.{}", file, ::getpid());
  if (errno == EEXIST)
    logging::log(logging::Level::info, "{} exists, this process is recorded in {}", file, other);
  return errno == EEXIST ? other : file;
}

}  // namespace

void Recording::name_thread() {
  const std::uint64_t thread = recorded_thread();
  if (thread == last_thread_) return;
  last_thread_ = thread;
  records_.append_plain(event::thread, std::span(&thread, 1));
}

void Recording::end_frame(std::uint64_t width, std::uint64_t height) {
  const std::scoped_lock lock(mutex_);
  name_thread();
  const std::uint64_t frame[] = {++frames_, width, height};
  records_.append_plain(event::frame, frame);
  ++frames_in_block_;
  write();
}

void Recording::flush(bool now) {
  const std::scoped_lock lock(mutex_);
  if (now || records_.words().size() + records_.payload().size() >= large_block_words) write();
}

void Recording::write() {
  if (records_.empty()) return;
  try {
    if (process_ != ::getpid()) {
      // A forked child must not write to its parent's file.
      process_ = ::getpid();
      writer_ = std::make_unique<TraceWriter>(claim(file_));
      failed_ = false;
    }
    if (!failed_) writer_->write(records_, frames_in_block_);
  } catch (const std::system_error& error) {
    failed_ = true;
    logging::log(logging::Level::error, "{}; recording ends here, give trace(file=…) a place with room",
                 error.what());
  }
  records_.clear();
  frames_in_block_ = 0;
}

}  // namespace understudy::spu
