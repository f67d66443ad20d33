// SPDX-License-Identifier: Apache-2.0
// The processes that draw the other tiles: GL servers (apps/understudy/gl_server/gl_server.h) which are played
// the same stream by the one that has the application. All contexts of the process use them.
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

/// Of one image, with the process that has the application.
constexpr int most_tiles = 16;

/// What a process says of itself in its hello to be a tile worker and no application.
struct TilePlace {
  int part = 0;  ///< from 1: tile 0 is the application's GL server's
  int parts = 1;
};
std::vector<std::byte> encode(const TilePlace& place);
/// Throws compositor::MalformedMessage.
TilePlace decode_tile_place(std::span<const std::byte> payload);

class TileWorkers {
 public:
  /// `socket`: where GL servers are asked for; every connection there is a tile worker of its own.
  explicit TileWorkers(std::string socket) : socket_(std::move(socket)) {}

  /// Has `parts` - 1 tile workers there, once. When they cannot be had that is said, and there are none.
  void gather(int parts);
  /// TileWorkers are there, and all have taken everything so far.
  bool here() const { return !workers_.empty(); }
  int count() const { return int(workers_.size()); }

  /// For records that all of them play next.
  Records& records() { return records_; }
  /// Records are sent when there are many, or now.
  void hand_on(bool now);

  /// Has tile worker `index`, from 0, play `records` behind all that was handed on, and answer the last one.
  void ask(int index, const Records& records);
  /// What it answered; waits. Nothing when tile workers are gone.
  CallAnswer answer(int index);

  /// Contexts whose windows are in tiles. When that has been given up, the last one lets the tile workers go.
  void begin_tiles() { ++in_tiles_; }
  void end_tiles();
  /// Why no window is to be in tiles from now on; null: they may.
  const char* given_up() const { return given_up_; }
  /// `why` stays for ever.
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
