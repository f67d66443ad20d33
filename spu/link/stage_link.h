// The process's one connection to the stage that makes its OpenGL calls. All threads use it, one at a time.
//
// A connection that is lost is lost for good: that is said once, and whatever is asked from then on is answered
// with nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compositor/service/connection.h"
#include "spu/link/front_end.h"
#include "spu/link/stage_protocol.h"
#include "spu/stream/call_answer.h"
#include "spu/stream/record.h"

namespace understudy::spu {

class StageLink {
 public:
  /// Connects to the Unix socket `address`. Throws std::runtime_error with what to do when no stage answers
  /// there. `front` must outlive the link.
  StageLink(const std::string& address, FrontEnd& front);

  const StageVersions& versions() const { return versions_; }
  FrontEnd& front() { return front_; }
  bool lost() const { return lost_; }

  /// Sends what the calling thread's context does.
  void send(const Records& records);
  /// And waits for what the last record answers; nothing when the stage is lost.
  std::optional<CallAnswer> ask(const Records& records);
  /// The records end with a `frame` event: waits for the picture and shows it in `drawable`, the thread's.
  void show_frame(const Records& records, std::uint64_t drawable);

  /// The same text at an address that stays for ever, as applications expect of glGetString.
  const char* keep_text(const std::string& text);

 private:
  void transmit(const Records& records, StageReply reply);
  compositor::Message receive(compositor::MessageType expected);
  void lose(const std::string& why);

  FrontEnd& front_;
  std::mutex mutex_;
  std::optional<compositor::Connection> connection_;
  StageVersions versions_;
  ChunkSender chunks_;
  std::atomic<bool> lost_ = false;
  std::map<std::uint64_t, std::pair<Extent2D, std::vector<std::uint8_t>>> pictures_;  ///< by drawable
  std::set<std::string> texts_;
};

}  // namespace understudy::spu
