#include "spu/report/counters.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace understudy::spu {
namespace {

// The counters live at one address for ever: in the program's zero pages, over which the launcher's file is
// mapped. Pointers to them that threads hold stay right whether there is a file or not, and in a child after
// fork.
constexpr std::size_t page = 65536;  // the largest page size of the systems we know
constexpr std::size_t whole_pages = (sizeof(ProcessCounters) + page - 1) / page * page;
alignas(page) constinit std::array<std::byte, whole_pages> memory{};

ProcessCounters& counters_in_memory() {
  return *std::launder(reinterpret_cast<ProcessCounters*>(memory.data()));
}

void map_file_of_this_process() {
  const char* folder = std::getenv("UNDERSTUDY_RUN_DIR");
  if (folder == nullptr || *folder == '\0') return;
  std::array<char, 4096> path{};
  const int length =
      std::snprintf(path.data(), path.size(), "%s/%d.counters", folder, static_cast<int>(getpid()));
  if (length < 0 || static_cast<std::size_t>(length) >= path.size()) return;
  const int file = open(path.data(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return;
  // The space is claimed now: a full disk must cost the figures, not a SIGBUS in the viewer.
  if (posix_fallocate(file, 0, static_cast<off_t>(whole_pages)) == 0) {
    // Where this fails the zero pages stay, and the counting goes on in private.
    (void)mmap(memory.data(), whole_pages, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0);
  }
  close(file);
}

void introduce_this_process() {
  ProcessCounters& counters = counters_in_memory();
  counters.magic = counters_magic;
  counters.pid = static_cast<std::int32_t>(getpid());
  std::array<char, sizeof counters.program> program{};
  const ssize_t length = readlink("/proc/self/exe", program.data(), program.size() - 1);
  if (length <= 0) std::strncpy(program.data(), program_invocation_name, program.size() - 1);
  std::memcpy(counters.program, program.data(), program.size());
}

/// A child counts for itself, at the same address: its parent's pages are shared and must not see the child's
/// calls.
void start_anew_after_fork() {
  (void)mmap(memory.data(), whole_pages, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1,
             0);
  map_file_of_this_process();
  introduce_this_process();
}

bool open_counters() {
  map_file_of_this_process();
  introduce_this_process();
  pthread_atfork(nullptr, nullptr, start_anew_after_fork);
  return true;
}

template <typename Number>
void add(Number& total, Number amount) {
  std::atomic_ref<Number>(total).fetch_add(amount, std::memory_order_relaxed);
}

void add(volume::FrameCounts& total, const volume::FrameCounts& frame) {
  add(total.rays, frame.rays);
  add(total.rays_terminated, frame.rays_terminated);
  add(total.samples, frame.samples);
  add(total.samples_taken, frame.samples_taken);
  add(total.blocks, frame.blocks);
  add(total.blocks_empty, frame.blocks_empty);
  add(total.bytes_exchanged, frame.bytes_exchanged);
  add(total.nodes_idle, frame.nodes_idle);
  add(total.render_ms, frame.render_ms);
  add(total.composite_ms, frame.composite_ms);
}

}  // namespace

ProcessCounters& process_counters() {
  static const bool opened = open_counters();
  (void)opened;
  return counters_in_memory();
}

void count_frame(const FrameRecord& frame) {
  ProcessCounters& counters = process_counters();
  const std::uint64_t number = counters.frames.fetch_add(1);
  counters.frame[number % max_frame_records] = frame;
  if (frame.substituted > 0) counters.frames_substituted.fetch_add(1);
  if (frame.left > 0) counters.frames_left.fetch_add(1);
  add(counters.total, frame.counts);
}

void forget_counted_frames() {
  ProcessCounters& counters = process_counters();
  counters.frames = 0;
  counters.frames_substituted = 0;
  counters.frames_left = 0;
  counters.total = {};
}

std::uint64_t* thread_call_counter() {
  thread_local std::uint64_t* slot = nullptr;
  if (slot == nullptr) {
    ProcessCounters& counters = process_counters();
    slot = &counters.calls[std::min<std::uint32_t>(counters.threads.fetch_add(1), max_counted_threads - 1)];
  }
  return slot;
}

}  // namespace understudy::spu
