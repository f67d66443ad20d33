// SPDX-License-Identifier: Apache-2.0
// Plays a trace in a child process. If the driver crashes it, because the trace is damaged or the driver has a
// bug, the call at which it crashed is reported.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace understudy::launcher {

/// The exit status if the driver crashed the player.
constexpr int player_crashed = 5;

/// The record that is being played, in memory shared by both processes.
struct PlayedRecord {
  std::atomic<std::uint32_t> id = 0;  ///< 0: none yet
  std::atomic<std::uint64_t> number = 0;

  void is(std::uint32_t record_id) {
    id.store(record_id, std::memory_order_relaxed);
    number.fetch_add(1, std::memory_order_relaxed);
  }
};

/// Calls `play` in a child process and returns its result; exceptions propagate in the child only. If a
/// signal like SIGSEGV ends the child, prints the record that was being played and returns `player_crashed`;
/// for any other signal, returns 128 + signal. This process must be single-threaded. Throws std::system_error
/// if no child can be created.
int play_guarded(const std::filesystem::path& trace, const std::function<int(PlayedRecord&)>& play);

}  // namespace understudy::launcher
