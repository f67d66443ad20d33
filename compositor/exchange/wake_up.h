// SPDX-License-Identifier: Apache-2.0
// How ranks of one machine wake each other. MPI only polls: a rank that waits for long would take the processor
// from those that work, or sleep for a while and be late for what it waits for. So each rank sleeps at a
// slot of memory that all of them share, and whoever has sent it something notifies it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>

#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

class WakeUp {
 public:
  /// Memory for so many slots, which other processes find at /proc/PID/fd. Throws std::system_error.
  static FileDescriptor make_memory(int count);

  /// `mine` is the number of the slot at which this process sleeps. Throws std::system_error.
  WakeUp(const FileDescriptor& memory, int count, int mine);
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  /// How often this rank was notified. To be asked before one looks for what one waits for: what comes after
  /// that look is not slept through.
  std::uint32_t notified() const;
  /// Returns when this rank was notified once more than `notified`, or after `most`.
  void sleep(std::uint32_t notified, std::chrono::microseconds most);
  /// Costs next to nothing where nobody sleeps.
  void notify(int slot);

 private:
  struct Slot;
  std::span<Slot> slots_;
  int mine_;
};

}  // namespace understudy::compositor
