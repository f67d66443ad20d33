// SPDX-License-Identifier: Apache-2.0
#include "interceptor/contextless_calls.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "interceptor/open_core.h"
#include "spu/report/counters.h"

namespace understudy::interceptor {
namespace {

constinit std::atomic<std::uint64_t> calls = 0;
constinit std::atomic<pid_t> caller = 0;

void write_at(int file, std::size_t offset, const void* bytes, std::size_t size) {
  // A failed write only leaves its value out of the report.
  (void)!pwrite(file, bytes, size, static_cast<off_t>(offset));
}

/// Writes the same file that the core would keep (spu/report/counters.h), with zeros for all other counters.
void leave_counters(const char* folder) {
  char path[PATH_MAX];
  const int length = snprintf(path, sizeof path, "%s/%d.counters", folder, static_cast<int>(getpid()));
  if (length < 0 || length >= static_cast<int>(sizeof path)) return;
  const int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return;
  using Counters = spu::ProcessCounters;
  const std::uint64_t count = calls.load();
  const std::int32_t pid = getpid();
  char program[sizeof Counters::program] = {};
  if (readlink("/proc/self/exe", program, sizeof program - 1) < 0) program[0] = '\0';
  if (ftruncate(file, sizeof(Counters)) == 0) {
    write_at(file, offsetof(Counters, calls), &count, sizeof count);
    write_at(file, offsetof(Counters, program), program, sizeof program);
    write_at(file, offsetof(Counters, pid), &pid, sizeof pid);
    write_at(file, offsetof(Counters, magic), &spu::counters_magic, sizeof spu::counters_magic);
  }
  close(file);
}

[[gnu::destructor]] void at_library_end() {
  // A forked child inherits its parent's count and has nothing of its own to report.
  if (calls.load() == 0 || caller.load() != getpid() || core_is_out() || core() != nullptr) return;
  const char* folder = secure_getenv("UNDERSTUDY_RUN_DIR");
  if (folder != nullptr && *folder != '\0') leave_counters(folder);
}

}  // namespace

void count_window_system_call() {
  if (calls.fetch_add(1, std::memory_order_relaxed) == 0) caller.store(getpid(), std::memory_order_relaxed);
}

}  // namespace understudy::interceptor
