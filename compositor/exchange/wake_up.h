// SPDX-License-Identifier: Apache-2.0
// How ranks of one machine wake each other. MPI only polls: a rank that waits for long would take the processor
// from those that work, or sleep for a while and be late. So each rank sleeps on its slot of memory that all of
// them share, and whoever sends it something notifies it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>

#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

class WakeUp {
 public:
  /// Makes memory for `count` slots, which other processes find at /proc/PID/fd. Throws std::system_error.
  static FileDescriptor make_memory(int count);

  /// `mine` is the index of the slot on which this process sleeps. Throws std::system_error.
  WakeUp(const FileDescriptor& memory, int count, int mine);
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  /// How often this rank was notified. To be read before checking for what one waits for: sleep() then returns
  /// at once if a notification comes after the check.
  std::uint32_t notified() const;
  /// Returns when this rank has been notified since `notified` was read, or after `most`.
  void sleep(std::uint32_t notified, std::chrono::microseconds most);
  /// Notifies the rank of a slot. Costs next to nothing if that rank does not sleep.
  void notify(int slot);

 private:
  struct Slot;
  std::span<Slot> slots_;
  int mine_;
};

}  // namespace understudy::compositor
