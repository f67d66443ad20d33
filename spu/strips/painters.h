// The processes that draw the other strips: stages (apps/understudy/stage.h) which are played the same stream
// by the one that has the application. All contexts of the process use them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "compositor/service/connection.h"
#include "spu/link/chunks.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Of one picture, with the process that has the application.
constexpr int most_strips = 16;

/// What a process says of itself in its hello to be a painter and no application.
struct PainterPlace {
  int part = 0;  ///< from 1: strip 0 is the application's stage's
  int parts = 1;
};
std::vector<std::byte> encode(const PainterPlace& place);
/// Throws compositor::MalformedMessage.
PainterPlace decode_painter_place(std::span<const std::byte> payload);

class Painters {
 public:
  /// `socket`: where stages are asked for; every connection there is a painter of its own.
  explicit Painters(std::string socket) : socket_(std::move(socket)) {}

  /// Has `parts` - 1 painters there, once. When they cannot be had that is said, and there are none.
  void gather(int parts);
  /// Painters are there, and all have taken everything so far.
  bool here() const { return !painters_.empty(); }
  int count() const { return int(painters_.size()); }

  /// For records that all of them play next.
  Records& records() { return records_; }
  /// Records are sent when there are many, or now.
  void hand_on(bool now);

  /// Has painter `index`, from 0, play `records` behind all that was handed on, and answer the last one.
  void ask(int index, const Records& records);
  /// What it answered; waits. Nothing when painters are gone.
  CallAnswer answer(int index);

  /// Contexts whose windows are in strips. When that has been given up, the last one lets the painters go.
  void begin_strips() { ++in_strips_; }
  void end_strips();
  /// Why no window is to be in strips from now on; null: they may.
  const char* given_up() const { return given_up_; }
  /// `why` stays for ever.
  void give_up(const char* why);

  std::atomic<bool>& lists_touch_scissor() { return lists_touch_scissor_; }

 private:
  struct Painter {
    compositor::Connection connection;
    ChunkSender chunks;
  };

  void send(Painter& painter, const Records& records, bool wants_answer);
  void lose(const char* what);
  void let_go_if_unused();

  const std::string socket_;
  std::vector<std::unique_ptr<Painter>> painters_;
  Records records_;
  bool gathered_ = false;
  int in_strips_ = 0;
  const char* given_up_ = nullptr;
  std::atomic<bool> lists_touch_scissor_ = false;
};

}  // namespace understudy::spu
