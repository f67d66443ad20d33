// SPDX-License-Identifier: Apache-2.0
// Plays a recorded stream: contexts appear, become current and go as they did, every record becomes its call
// again, and each context's calls run through a chain of units.
//
// The threads of a recorded application are played on one thread in the order of the stream.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "spu/chain.h"
#include "spu/options.h"
#include "spu/stream/decode.h"
#include "spu/stream/record.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

class RenderSession;

/// The drawable shows what was drawn. Its context is current and nothing is held back.
struct ShownFrame {
  std::uint64_t number = 0;  ///< as recorded; 0: no frame has ended, but the front buffer was drawn into
  Extent2D extent;
};

class Player {
 public:
  /// `options.chain` is what stands above the driver in every context.
  Player(WindowSystem& windows, const Options& options, StreamOrigin origin = StreamOrigin::elsewhere);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  /// Plays one record. Returns what is wrong with it, or nothing; playing may go on in both cases. Throws
  /// std::runtime_error when a context or the chain cannot be made.
  std::string play(const Record& record);

  /// Called before the frame counts as ended.
  std::function<void(const ShownFrame&)> on_frame;
  /// The application read this image back.
  std::function<void(const Decoder::ReadImage&)> on_read;

  /// Makes the context of the thread whose records come next the current one, as play() does. False when it has
  /// none.
  bool prepare() { return activate() != nullptr; }

  struct PlayedContext {
    std::uint64_t number = 0;
    std::uint64_t group = 0;  ///< contexts of one group share objects
    Extent2D drawable;        ///< that it was current with last
  };
  /// What the last call of a linked stream has answered.
  const CallAnswer& call_answer() const;
  /// The one that is current; number 0 when none is.
  PlayedContext current() const;
  /// What its drawable shows (shown_image.h), whoever has drawn it; for on_frame.
  std::vector<std::uint8_t> shown_image() const;
  /// Pixels that the last call read; empty when it read none.
  const Decoder::ReadImage& read_image() const;
  /// Number of the drawable that is current.
  std::uint64_t drawable() const { return active_drawable_; }
  std::vector<PlayedContext> contexts() const;
  /// What an object that contexts share is called here, for the current context.
  std::uint64_t here(ObjectKind kind, std::uint64_t there) const;
  const DispatchTable& driver() const { return windows_.driver(); }

 private:
  struct Group;
  struct Context;
  struct Thread {
    std::uint64_t context = 0;
    std::uint64_t drawable = 0;
    Extent2D extent;
  };

  std::string introduce(const Record& record);
  std::string make_current(const Record& record);
  std::string end_context(const Record& record);
  std::string end_frame(const Record& record);
  std::string show_front(const Record& record);
  std::string call(const Record& record);
  std::shared_ptr<Group> group_of(const RecordedContext& context);
  void leave();
  /// Makes the context of the thread whose records are being played the current one.
  Context* activate();

  WindowSystem& windows_;
  const Options options_;
  const StreamOrigin origin_;
  std::shared_ptr<RenderSession> session_;
  std::map<std::uint64_t, std::unique_ptr<Context>> contexts_;
  std::map<std::uint64_t, std::shared_ptr<Group>> groups_;  ///< by context, also of those that are gone
  std::map<std::uint64_t, Thread> threads_;
  std::uint64_t thread_ = 0;  ///< whose records are being played
  std::uint64_t active_ = 0;
  std::uint64_t active_drawable_ = 0;
  Extent2D active_extent_;
};

}  // namespace understudy::spu
