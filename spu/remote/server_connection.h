// SPDX-License-Identifier: Apache-2.0
// The process's one connection to the GL server that makes its OpenGL calls. All threads use it, one at a time;
// what comes back is received by a thread of the connection's own, so that images are shown as they come.
//
// A connection that is lost is lost for good: that is said once, and whatever is asked from then on is answered
// with nothing.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "compositor/transport/connection.h"
#include "spu/remote/front_end.h"
#include "spu/remote/gl_server_protocol.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// That are on their way at once: the application draws the next one while the GL server is at the last.
constexpr std::size_t frames_in_flight = 2;
/// For the last ones of a program that ends.
constexpr std::chrono::milliseconds last_frames_patience{1'000};

class ServerConnection {
 public:
  /// Connects to the Unix socket `address`. Throws std::runtime_error with what to do when no GL server answers
  /// there. `front` must outlive the connection.
  ServerConnection(const std::string& address, FrontEnd& front);
  ~ServerConnection();
  ServerConnection(const ServerConnection&) = delete;
  ServerConnection& operator=(const ServerConnection&) = delete;

  const GlServerVersions& versions() const { return versions_; }
  FrontEnd& front() { return front_; }
  bool lost() const { return lost_; }

  /// Sends what the calling thread's context does.
  void send(const Records& records);
  /// And waits for what the last record answers; nothing when the GL server is lost. All frames before are
  /// shown then.
  std::optional<CallAnswer> ask(const Records& records);
  /// The same for several questions, all of which are on their way at once: answers in their order, or none
  /// when the GL server is lost.
  std::vector<CallAnswer> ask_all(std::span<const Records> questions);
  /// The records end with a `frame` event, whose image will be shown in `drawable`. Waits while too many
  /// frames are on their way.
  void show_frame(const Records& records, const FrontDrawable& drawable);
  /// What is in its front buffer will be shown in `drawable`. Never waits: while frames are on their way it is
  /// pending, and asked for when they have come. False when it is pending.
  bool show_front(const FrontDrawable& drawable);
  /// The same, but waits while too many frames are on their way.
  void show_front_now(const FrontDrawable& drawable);
  /// Whether the drawable's front buffer was to be shown and is not on its way yet. A frame that is shown ends
  /// that.
  bool is_front_pending(const FrontDrawable& drawable);
  /// Waits until all frames are shown.
  void wait_for_frames();

  /// The same text at an address that stays for ever, as applications expect of glGetString.
  const char* keep_text(const std::string& text);

  /// The program is ending: frames on their way are still shown if they come within
  /// last_frames_patience, then nothing is waited for, or said, any more. May be called from a signal
  /// handler that calls exit(), whatever the thread is in the midst of.
  void end();

 private:
  struct Shown {
    FrontDrawable drawable;
    Extent2D extent;
    std::vector<std::uint8_t> pixels;
  };

  struct PendingFront {
    std::uint64_t thread = 0;  ///< whose context has the drawable
    FrontDrawable drawable;
  };

  std::thread start(void (ServerConnection::*work)());
  void transmit(const Records& records, ServerReply reply, std::uint64_t thread);
  void lose(std::string_view why);
  void receive_all();
  void show_pending();
  void take(compositor::Message message);
  void take_image(const compositor::Message& message);
  void refine_image(const compositor::Message& message);
  void put(Shown& shown, const ImageChange& change);
  template <class Condition>
  void wait_until(std::unique_lock<std::mutex>& lock, Condition condition);

  FrontEnd& front_;
  std::optional<compositor::Connection> connection_;
  GlServerVersions versions_;
  std::atomic<bool> lost_ = false;
  std::once_flag losing_;
  std::atomic<bool> ending_ = false;  ///< nothing is said any more
  std::atomic<bool> ended_ = false;   ///< nor shown

  std::mutex sending_;  ///< held from a question to its answer
  ChunkSender chunks_;
  std::set<std::string> texts_;

  std::mutex replies_;
  std::condition_variable replied_;
  std::vector<CallAnswer> answers_;
  std::size_t awaited_ = 0;                        ///< answers to questions on their way
  std::deque<FrontDrawable> frames_;               ///< on their way, the oldest first
  std::map<std::uint64_t, PendingFront> pending_;  ///< by drawable
  // For who may not wait for a lock.
  std::atomic<std::uint64_t> frames_sent_ = 0;
  std::atomic<std::uint64_t> frames_shown_ = 0;

  std::map<std::uint64_t, Shown> images_;  ///< by drawable; the receiving thread's
  std::thread receiver_;
  std::thread pending_shower_;  ///< started when something is pending
};

}  // namespace understudy::spu
