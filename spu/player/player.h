// SPDX-License-Identifier: Apache-2.0
// Plays a recorded stream: contexts are created, become current and are destroyed as recorded, every record is
// turned back into its call, and each context's calls run through a chain of units.
//
// All threads of a recorded application are played on one thread, in the order of the stream.
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

/// A frame that the drawable shows. Its context is current and nothing is held back.
struct ShownFrame {
  std::uint64_t number = 0;  ///< as recorded; 0: not a frame end, but drawing into the front buffer
  Extent2D extent;
};

class Player {
 public:
  /// `options.chain` describes the units above the driver in every context.
  Player(WindowSystem& windows, const Options& options, StreamOrigin origin = StreamOrigin::elsewhere);
  ~Player();
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  /// Plays one record. Returns an error in the record, or an empty string; playing may continue in both cases.
  /// Throws std::runtime_error if a context or the chain cannot be created.
  std::string play(const Record& record);

  /// Called before the frame is counted as ended.
  std::function<void(const ShownFrame&)> on_frame;
  /// Called when the application has read an image back.
  std::function<void(const Decoder::ReadImage&)> on_read;

  /// Makes the context of the thread whose records come next current, as play() does. Returns false if that
  /// thread has none.
  bool prepare() { return activate() != nullptr; }

  struct PlayedContext {
    std::uint64_t number = 0;
    std::uint64_t group = 0;  ///< contexts of one group share objects
    Extent2D drawable;        ///< size of the drawable that it was last current with
  };
  /// The results of the last call of a linked stream.
  const CallAnswer& call_answer() const;
  /// The current context; number 0 if there is none.
  PlayedContext current() const;
  /// What the current drawable shows (shown_image.h), whichever process has drawn it; for on_frame.
  std::vector<std::uint8_t> shown_image() const;
  /// Pixels that the last call read; empty if it read none.
  const Decoder::ReadImage& read_image() const;
  /// The number of the current drawable.
  std::uint64_t drawable() const { return active_drawable_; }
  std::vector<PlayedContext> contexts() const;
  /// The local name of a shared object, for the current context, given its name in the stream.
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
  /// Makes the context of the thread whose records are being played current.
  Context* activate();

  WindowSystem& windows_;
  const Options options_;
  const StreamOrigin origin_;
  std::shared_ptr<RenderSession> session_;
  std::map<std::uint64_t, std::unique_ptr<Context>> contexts_;
  std::map<std::uint64_t, std::shared_ptr<Group>> groups_;  ///< by context, including destroyed ones
  std::map<std::uint64_t, Thread> threads_;
  std::uint64_t thread_ = 0;  ///< whose records are being played
  std::uint64_t active_ = 0;
  std::uint64_t active_drawable_ = 0;
  Extent2D active_extent_;
};

}  // namespace understudy::spu
