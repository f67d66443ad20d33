// SPDX-License-Identifier: Apache-2.0
#include "spu/report/counters.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <mutex>
#include <new>
#include <utility>

#include "compositor/logging/log.h"

namespace understudy::spu {
namespace {

// The counters have one address for the life of the process: in the program's zero pages, over which the
// launcher's file is mapped. Threads' pointers to them stay valid with or without a file, and in a forked
// child.
constexpr std::size_t page = 65536;  // the largest page size of known systems
constexpr std::size_t whole_pages = (sizeof(ProcessCounters) + page - 1) / page * page;
alignas(page) constinit std::array<std::byte, whole_pages> memory{};

/// This process is a forked child that has no file yet.
constinit std::atomic<bool> forked = false;
/// The calling thread's slot in ProcessCounters::calls; null before its first call.
constinit thread_local std::uint64_t* call_counter = nullptr;

ProcessCounters& counters_in_memory() {
  return *std::launder(reinterpret_cast<ProcessCounters*>(memory.data()));
}

void say_that_figures_are_lost(const char* path, int reason) {
  logging::log(logging::Level::error, "the figures of this process cannot be kept in {}: {}", path,
               std::strerror(reason));
}

/// Writes what was counted without a file. Returns 0, or the reason of a failure.
int write_figures(int file) {
  const ssize_t written = pwrite(file, memory.data(), sizeof(ProcessCounters), 0);
  if (written == static_cast<ssize_t>(sizeof(ProcessCounters))) return 0;
  return written < 0 ? errno : ENOSPC;
}

/// A process that executes another program continues its file, so figures are written only if there are some.
void map_file_of_this_process(bool has_figures) {
  const char* folder = ::secure_getenv("UNDERSTUDY_RUN_DIR");
  if (folder == nullptr || *folder == '\0') return;
  std::array<char, 4096> path{};
  const int length =
      std::snprintf(path.data(), path.size(), "%s/%d.counters", folder, static_cast<int>(getpid()));
  if (length < 0 || static_cast<std::size_t>(length) >= path.size()) return;
  const int file = open(path.data(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return say_that_figures_are_lost(path.data(), errno);
  // The space is allocated now, so that a full disk only loses the figures instead of raising SIGBUS in the
  // viewer. If this fails, the private pages stay as counters, and the empty file informs the launcher.
  int reason = posix_fallocate(file, 0, static_cast<off_t>(whole_pages));
  if (reason == 0 && has_figures) reason = write_figures(file);
  if (reason != 0) {
    say_that_figures_are_lost(path.data(), reason);
    if (ftruncate(file, 0) != 0) unlink(path.data());
  } else {
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

/// A child has its own counters at the same address: its parent's pages are shared and must not count the
/// child's calls. It gets a file when it first needs its counters, because most children only execute another
/// program.
void start_anew_after_fork() {
  (void)mmap(memory.data(), whole_pages, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1,
             0);
  call_counter = nullptr;
  forked = true;
}

bool open_counters() {
  map_file_of_this_process(false);
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
  add(total.samples_hidden, frame.samples_hidden);
  add(total.dominated_samples, frame.dominated_samples);
  add(total.nodes_idle, frame.nodes_idle);
  add(total.bytes_exchanged, frame.bytes_exchanged);
  add(total.bytes_of_whole_windows, frame.bytes_of_whole_windows);
  add(total.messages, frame.messages);
  add(total.messages_of_whole_windows, frame.messages_of_whole_windows);
  add(total.render_ms, frame.render_ms);
  add(total.composite_ms, frame.composite_ms);
}

/// The last slot takes all reasons that have no slot of their own.
void add_reason(std::span<ReasonCount> slots, std::string_view reason, std::uint64_t times) {
  const std::string_view known = reason.substr(0, sizeof ReasonCount::reason - 1);
  ReasonCount& last = slots.back();
  for (ReasonCount& slot : slots) {
    if (slot.reason[0] == 0) put_text(slot.reason, &slot == &last ? "other reasons" : known);
    if (&slot == &last || std::string_view(slot.reason) == known) {
      slot.count.fetch_add(times, std::memory_order_relaxed);
      return;
    }
  }
}

/// Adds the figures of a volume that no longer exists to those of `last`, and resets its own.
void hand_on(VolumeCounters& volume, VolumeCounters& last) {
  last.draws_substituted.fetch_add(volume.draws_substituted.exchange(0));
  last.draws_left.fetch_add(volume.draws_left.exchange(0));
  last.probes.fetch_add(volume.probes.exchange(0));
  for (ReasonCount& reason : volume.left_because) {
    if (const std::uint64_t times = reason.count.exchange(0); times > 0)
      count_reason(last, reason.reason, times);
    put_text(reason.reason, "");
  }
  last.verified_frames.fetch_add(volume.verified_frames.exchange(0));
  last.verify_max = std::max(last.verify_max, std::exchange(volume.verify_max, 0));
  add(last.verify_sum_sq, std::exchange(volume.verify_sum_sq, 0));
  if (const double worst = std::exchange(volume.verify_worst_tile, 0); worst >= last.verify_worst_tile) {
    last.verify_worst_tile = worst;
    last.verify_worst_frame = volume.verify_worst_frame;
  }
  last.verified_tiles.fetch_add(volume.verified_tiles.exchange(0));
  last.verify_lost.fetch_add(volume.verify_lost.exchange(0));
  put_text(volume.explanation, "");
  put_text(volume.scene, "");
  // The reason of one brick is that of the whole volume.
  if (last.not_exported[0] == '\0') put_text(last.not_exported, volume.not_exported);
  put_text(volume.not_exported, "");
  put_text(volume.texture_format, "");
  std::fill(std::begin(volume.size), std::end(volume.size), 0);
  put_text(last.explanation, "all volumes that found no place of their own any more, together");
}

}  // namespace

void put_text(std::span<char> field, std::string_view text) {
  const std::size_t length = std::min(text.size(), field.size() - 1);
  std::copy_n(text.begin(), length, field.begin());
  std::fill(field.begin() + std::ptrdiff_t(length), field.end(), char(0));
}

VolumeCounters& count_volume(std::uint64_t texture) {
  ProcessCounters& process = process_counters();
  const std::uint32_t number = process.volumes.fetch_add(1) + 1;
  VolumeCounters& last = process.volume[max_counted_volumes - 1];
  VolumeCounters* found = &last;
  for (const VolumePlace wanted : {VolumePlace::free, VolumePlace::given_up, VolumePlace::left_behind}) {
    for (int i = 0; i < max_counted_volumes - 1 && found == &last; ++i) {
      VolumePlace place = wanted;
      if (process.volume[i].place.compare_exchange_strong(place, VolumePlace::held)) found = &process.volume[i];
    }
    if (found == &last) continue;
    if (wanted == VolumePlace::left_behind) hand_on(*found, last);
    break;
  }
  if (found == &last) last.place = VolumePlace::held;
  found->texture = texture;
  found->number = number;
  return *found;
}

VolumeCounters& count_as_one(std::span<VolumeCounters* const> parts) {
  ProcessCounters& process = process_counters();
  VolumeCounters& last = process.volume[max_counted_volumes - 1];
  const auto own =
      std::find_if(parts.begin(), parts.end(), [&](VolumeCounters* part) { return part != &last; });
  VolumeCounters& whole = own == parts.end() ? last : **own;
  for (VolumeCounters* const part : parts) {
    if (part == &whole || part->place == VolumePlace::given_up) continue;
    process.volumes_merged.fetch_add(1);
    if (part == &last) continue;  // other volumes may share it
    hand_on(*part, whole);
    part->place = VolumePlace::given_up;
  }
  const auto places =
      std::count_if(std::begin(process.volume), std::end(process.volume) - 1, [](const VolumeCounters& volume) {
        return volume.place == VolumePlace::held || volume.place == VolumePlace::left_behind;
      });
  const std::uint32_t distinct = process.volumes - process.volumes_merged;
  if (&whole != &last && last.place == VolumePlace::held && distinct <= std::uint32_t(places)) {
    hand_on(last, whole);
    last.place = VolumePlace::given_up;
  }
  return whole;
}

void leave_behind(VolumeCounters& volume) {
  VolumePlace held = VolumePlace::held;
  volume.place.compare_exchange_strong(held, VolumePlace::left_behind);
}

void count_reason(VolumeCounters& volume, std::string_view reason, std::uint64_t times) {
  add_reason(volume.left_because, reason, times);
}

void count_done(Optimization optimization, std::string_view reason) {
  static constinit std::mutex mutex;  // several threads' contexts may count at once
  const std::scoped_lock lock(mutex);
  add_reason(process_counters().done_because[std::size_t(optimization)], reason, 1);
}

ProcessCounters& process_counters() {
  static const bool opened = open_counters();
  (void)opened;
  if (forked.load(std::memory_order_relaxed) && forked.exchange(false)) {
    map_file_of_this_process(true);
    introduce_this_process();
  }
  return counters_in_memory();
}

void count_frame(const FrameRecord& frame) {
  ProcessCounters& counters = process_counters();
  const std::uint64_t number = counters.frames.fetch_add(1);
  counters.frame[number % max_frame_records] = frame;
  if (frame.substituted > 0) counters.frames_substituted.fetch_add(1);
  if (frame.left > 0) counters.frames_left.fetch_add(1);
  add(counters.total, frame.counts);
  for (std::size_t i = 0; i < optimization_count; ++i) {
    add(counters.total_amounts[i].done, frame.amounts[i].done);
    add(counters.total_amounts[i].left_out, frame.amounts[i].left_out);
  }
}

void forget_counted_frames() {
  ProcessCounters& counters = process_counters();
  counters.frames = 0;
  counters.frames_substituted = 0;
  counters.frames_left = 0;
  counters.total = {};
  counters.total_amounts = {};
  for (auto& reasons : counters.done_because)
    for (ReasonCount& reason : reasons) reason.count = 0;
}

std::uint64_t* thread_call_counter() {
  if (call_counter == nullptr) {
    ProcessCounters& counters = process_counters();
    call_counter =
        &counters.calls[std::min<std::uint32_t>(counters.threads.fetch_add(1), max_counted_threads - 1)];
  }
  return call_counter;
}

}  // namespace understudy::spu
