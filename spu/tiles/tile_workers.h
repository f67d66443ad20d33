// SPDX-License-Identifier: Apache-2.0
// The processes that draw the other tiles: GL servers (apps/understudy/gl_server/gl_server.h) that get the same
// stream from the process which serves the application. Shared by all contexts of that process.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "compositor/transport/connection.h"
#include "spu/remote/chunks.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Limit for the tiles of an image, including the one of the process that serves the application.
constexpr int most_tiles = 16;

/// What a process sends in its hello to start a tile worker instead of serving an application.
struct TilePlace {
  int part = 0;  ///< from 1: tile 0 belongs to the GL server of the application
  int parts = 1;
};
std::vector<std::byte> encode(const TilePlace& place);
/// Throws compositor::MalformedMessage.
TilePlace decode_tile_place(std::span<const std::byte> payload);

class TileWorkers {
 public:
  /// `socket`: where GL servers are requested; every connection to it is a separate tile worker.
  explicit TileWorkers(std::string socket) : socket_(std::move(socket)) {}

  /// Starts `parts` - 1 tile workers, on the first call only. If that fails, it is logged and there are none.
  void gather(int parts);
  /// Whether there are tile workers; all of them have received all records so far.
  bool here() const { return !workers_.empty(); }
  int count() const { return int(workers_.size()); }

  /// Records that all tile workers will play next.
  Records& records() { return records_; }
  /// Sends the records if there are many, or if `now`.
  void hand_on(bool now);

  /// Lets tile worker `index`, from 0, play `records` after everything that was sent before, and answer the
  /// last one.
  void ask(int index, const Records& records);
  /// Waits for that answer and returns it; empty if the tile workers are lost.
  CallAnswer answer(int index);

  /// Counts contexts whose windows are divided into tiles. After tiles were given up, the last one to end
  /// releases the tile workers.
  void begin_tiles() { ++in_tiles_; }
  void end_tiles();
  /// Why windows are not divided into tiles any more; null if they are.
  const char* given_up() const { return given_up_; }
  /// `why` must stay valid forever.
  void give_up(const char* why);

  std::atomic<bool>& lists_touch_scissor() { return lists_touch_scissor_; }

 private:
  struct TileWorker {
    compositor::Connection connection;
    ChunkSender chunks;
  };

  void send(TileWorker& worker, const Records& records, bool wants_answer);
  void lose(const char* what);
  void let_go_if_unused();

  const std::string socket_;
  std::vector<std::unique_ptr<TileWorker>> workers_;
  Records records_;
  bool gathered_ = false;
  int in_tiles_ = 0;
  const char* given_up_ = nullptr;
  std::atomic<bool> lists_touch_scissor_ = false;
};

}  // namespace understudy::spu
