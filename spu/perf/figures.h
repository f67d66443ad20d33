// SPDX-License-Identifier: Apache-2.0
// The figures that are counted of calls and frames, and their output formats.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// Counted by one thread, read by any thread.
class Count {
 public:
  Count() = default;
  Count(const Count& other) { set(other.get()); }
  Count& operator=(const Count& other) {
    set(other.get());
    return *this;
  }
  void add(std::uint64_t amount) { set(get() + amount); }
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

struct CallFigures {
  Count calls;
  Count nanoseconds;  ///< in everything below the unit, including reading the clock
  Count bytes;        ///< that the call's pointers refer to
  Count round_trips;  ///< to a GL server (run --remote), which the call waited for

  void add(const CallFigures& other);
  void keep_largest(const CallFigures& other);
};

struct Figures {
  std::array<CallFigures, call_count> by_call;
  Count frames;             ///< ended frames
  CallFigures in_frames;    ///< sum over the ended frames
  CallFigures largest;      ///< each figure's maximum over the frames
  Count frame_nanoseconds;  ///< from frame end to frame end

  void add(const Figures& other);
  CallFigures total() const;
};

/// The calls that were made, costliest first, as a readable table.
std::string figures_text(const Figures& figures);
std::string figures_json(const Figures& figures);

}  // namespace understudy::spu
