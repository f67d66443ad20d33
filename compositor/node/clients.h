// SPDX-License-Identifier: Apache-2.0
// Rank 0's connections: one to the launcher, which passes on applications, and one to each application. One
// thread, one poll(). An application that is slow, stops in the middle of a message or sends malformed data is
// dropped with one log line, and never keeps the others waiting.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "compositor/node/heartbeat.h"
#include "compositor/node/turns.h"
#include "compositor/service/image_buffer.h"
#include "compositor/transport/connection.h"

namespace understudy::compositor {

class Clients {
 public:
  /// An application's message; image_buffer never appears here.
  struct Request {
    std::uint64_t client = 0;
    Message message;
  };
  /// An application has gone or was dropped; its data may be freed.
  struct Departed {
    std::uint64_t client = 0;
  };
  /// An application has given new memory for its images; zero bytes: the memory was unusable.
  struct MemoryGiven {
    std::uint64_t client = 0;
    ImageBuffer memory;
  };
  /// The launcher closed its connection: the group ends.
  struct Ended {};
  using Event = std::variant<Request, Departed, MemoryGiven, Ended>;

  /// Connects to the launcher at `control_path` and sends it a hello for `ranks` ranks. Throws
  /// std::runtime_error. An application may pause for `stall_patience` in the middle of a message.
  Clients(const std::string& control_path, int ranks, std::chrono::milliseconds stall_patience);

  /// Waits for the next event.
  Event next();

  /// Answers `request`; an application that does not take the answer at once is dropped.
  void reply(const Request& request, MessageType type, Bytes payload);

 private:
  bool hear_launcher();
  std::optional<Event> hear(std::uint64_t number, Connection& connection);
  static ImageBuffer take_image_buffer(Connection& connection, Message message);
  void drop(std::uint64_t number, const std::string& why);
  void end_turn();
  int wait_at_most(bool unfinished, Deadline now) const;

  Connection launcher_;
  std::optional<Heartbeat> heartbeat_;  // begins after the hello
  int ranks_;
  std::chrono::milliseconds stall_patience_;
  std::map<std::uint64_t, Connection> clients_;
  std::uint64_t last_number_ = 0;  // numbers are never reused
  std::uint64_t last_heard_ = 0;   // the next turn begins behind this one
  std::deque<std::uint64_t> departed_;
  Turns turns_;
  Deadline turn_began_{};  // of the application that was heard last; zero: its turn has ended
  bool refused_ = false;   // whether the request of this turn was refused
};

}  // namespace understudy::compositor
