// How ranks of one machine wake each other. MPI only polls: a rank that waits for long would take the processor
// from those that work, or sleep for a while and be late for what it waits for. So each rank sleeps at a
// wake-up, in memory that all of them share, and whoever has sent it something notifies.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>

#include "compositor/service/file_descriptor.h"

namespace understudy::compositor {

class WakeUp {
 public:
  /// Memory for so many wake-ups, which other processes find at /proc/PID/fd. Throws std::system_error.
  static FileDescriptor make_memory(int count);

  /// `mine` is the number of the wake-up at which this process sleeps. Throws std::system_error.
  WakeUp(const FileDescriptor& memory, int count, int mine);
  ~WakeUp();
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;

  /// How often mine was notified. To be asked before one looks for what one waits for: what comes after that
  /// look is not slept through.
  std::uint32_t notified() const;
  /// Returns when mine was notified once more than `notified`, or after `most`.
  void sleep(std::uint32_t notified, std::chrono::microseconds most);
  /// Costs next to nothing where nobody sleeps.
  void notify(int slot);

 private:
  struct Slot;
  std::span<Slot> wake_up_;
  int mine_;
};

}  // namespace understudy::compositor
