// How ranks of one machine wake each other. MPI only polls: a rank that waits for long would take the processor
// from those that work, or sleep for a while and be late for what it waits for. So each rank sleeps at a bell,
// in memory that all of them share, and whoever has sent it something rings.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>

#include "compositor/service/file_descriptor.h"

namespace understudy::compositor {

class Bells {
 public:
  /// Memory for so many bells, which other processes find at /proc/PID/fd. Throws std::system_error.
  static FileDescriptor make_memory(int count);

  /// `mine` is the number of the bell at which this process sleeps. Throws std::system_error.
  Bells(const FileDescriptor& memory, int count, int mine);
  ~Bells();
  Bells(const Bells&) = delete;
  Bells& operator=(const Bells&) = delete;

  /// How often mine was rung. To be asked before one looks for what one waits for: what comes after that look
  /// is not slept through.
  std::uint32_t rung() const;
  /// Returns when mine was rung once more than `rung`, or after `most`.
  void sleep(std::uint32_t rung, std::chrono::microseconds most);
  /// Costs next to nothing where nobody sleeps.
  void ring(int bell);

 private:
  struct Bell;
  std::span<Bell> bells_;
  int mine_;
};

}  // namespace understudy::compositor
