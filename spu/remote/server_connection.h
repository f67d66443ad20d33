// SPDX-License-Identifier: Apache-2.0
// The process's only connection to the GL server that makes its OpenGL calls. All threads use it, one at a
// time; replies are received by a separate thread, so that images are shown as they arrive.
//
// A lost connection stays lost: that is logged once, and all later queries are answered with nothing.
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

/// Limit for frames in transit: the application draws the next frame while the GL server works on the last.
constexpr std::size_t frames_in_flight = 2;
/// How long the last frames of an ending program are waited for.
constexpr std::chrono::milliseconds last_frames_patience{1'000};

class ServerConnection {
 public:
  /// Connects to the Unix socket `address`. If no GL server answers there, throws std::runtime_error with
  /// advice to the user. `front` must outlive the connection.
  ServerConnection(const std::string& address, FrontEnd& front);
  ~ServerConnection();
  ServerConnection(const ServerConnection&) = delete;
  ServerConnection& operator=(const ServerConnection&) = delete;

  const GlServerVersions& versions() const { return versions_; }
  FrontEnd& front() { return front_; }
  bool lost() const { return lost_; }

  /// Sends records of the calling thread's context.
  void send(const Records& records);
  /// Sends records and waits for the answer of the last one; nothing if the GL server is lost. All earlier
  /// frames have been shown on return.
  std::optional<CallAnswer> ask(const Records& records);
  /// The same for several queries that are in transit at the same time: returns the answers in order, or none
  /// if the GL server is lost.
  std::vector<CallAnswer> ask_all(std::span<const Records> questions);
  /// Sends records that end with a `frame` event, whose image will be shown in `drawable`. Waits while too many
  /// frames are in transit.
  void show_frame(const Records& records, const FrontDrawable& drawable);
  /// Requests that the contents of the front buffer are shown in `drawable`. Never waits: while frames are in
  /// transit the request is pending, and is sent after they have arrived. Returns false if it is pending.
  bool show_front(const FrontDrawable& drawable);
  /// The same, but waits while too many frames are on their way.
  void show_front_now(const FrontDrawable& drawable);
  /// Whether a request to show the drawable's front buffer is pending. A frame of the drawable replaces it.
  bool is_front_pending(const FrontDrawable& drawable);
  /// Waits until all frames are shown.
  void wait_for_frames();

  /// Returns the same text at an address that stays valid forever, as applications expect of glGetString.
  const char* keep_text(const std::string& text);

  /// The program is ending: frames in transit are still shown if they arrive within last_frames_patience; after
  /// that, nothing is waited for or logged. May be called in a signal handler that calls exit(), whatever the
  /// thread was doing.
  void end();

 private:
  struct Shown {
    FrontDrawable drawable;
    Extent2D extent;
    std::vector<std::uint8_t> pixels;
  };

  struct PendingFront {
    std::uint64_t thread = 0;  ///< the thread whose context has the drawable
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
  std::atomic<bool> ending_ = false;  ///< log nothing any more
  std::atomic<bool> ended_ = false;   ///< show nothing any more

  std::mutex sending_;  ///< held from a query to its answer
  ChunkSender chunks_;
  std::set<std::string> texts_;

  std::mutex replies_;
  std::condition_variable replied_;
  std::vector<CallAnswer> answers_;
  std::size_t awaited_ = 0;                        ///< answers to queries in transit
  std::deque<FrontDrawable> frames_;               ///< in transit, oldest first
  std::map<std::uint64_t, PendingFront> pending_;  ///< by drawable
  // Atomic for end(), which must not wait for a lock.
  std::atomic<std::uint64_t> frames_sent_ = 0;
  std::atomic<std::uint64_t> frames_shown_ = 0;

  std::map<std::uint64_t, Shown> images_;  ///< by drawable; used by the receiving thread only
  std::thread receiver_;
  std::thread pending_shower_;  ///< started when a request is pending
};

}  // namespace understudy::spu
