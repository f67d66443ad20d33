// SPDX-License-Identifier: Apache-2.0
// A trace is played in a child process: what a driver does to a process that makes calls as nobody would make
// them (a damaged trace, a driver's own fault) is told with the call at which it happened.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace understudy::launcher {

/// The exit status where a signal of the driver's has ended the player.
constexpr int player_crashed = 5;

/// Which record is being played, in memory that both processes see.
struct PlayedRecord {
  std::atomic<std::uint32_t> id = 0;  ///< 0: none yet
  std::atomic<std::uint64_t> number = 0;

  void is(std::uint32_t record_id) {
    id.store(record_id, std::memory_order_relaxed);
    number.fetch_add(1, std::memory_order_relaxed);
  }
};

/// Calls `play` in a child process and answers what it answered there; what it throws, it throws in the child.
/// Says which record was being played and returns `player_crashed` when a signal like SIGSEGV ended the child,
/// 128 + signal for any other. There must be no second thread. Throws std::system_error when there is no second
/// process.
int play_guarded(const std::filesystem::path& trace, const std::function<int(PlayedRecord&)>& play);

}  // namespace understudy::launcher
