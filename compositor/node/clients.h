// SPDX-License-Identifier: Apache-2.0
// Rank 0's side of the communicator to the applications: the connection to the launcher, which hands over
// applications, and one connection per application. One thread, one poll; an application that is slow, silent
// in the middle of a message, or talks nonsense is dropped with one line and never keeps the others waiting.
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
  /// An application has gone or was dropped; what it left may be forgotten.
  struct Departed {
    std::uint64_t client = 0;
  };
  /// An application has given other memory for its images; without bytes: it was of no use.
  struct MemoryGiven {
    std::uint64_t client = 0;
    ImageBuffer memory;
  };
  /// The launcher closed its connection: time to end.
  struct Ended {};
  using Event = std::variant<Request, Departed, MemoryGiven, Ended>;

  /// Connects to the launcher at `control_path` and says hello for `ranks` ranks. Throws std::runtime_error.
  /// An application may pause for `stall_patience` in the middle of a message.
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
  std::optional<Heartbeat> heartbeat_;  // begins behind the hello
  int ranks_;
  std::chrono::milliseconds stall_patience_;
  std::map<std::uint64_t, Connection> clients_;
  std::uint64_t last_number_ = 0;  // numbers are never used twice
  std::uint64_t last_heard_ = 0;   // the next turn begins behind this one
  std::deque<std::uint64_t> departed_;
  Turns turns_;
  Deadline turn_began_{};  // of the application that was heard last; zero: its turn has ended
  bool refused_ = false;   // what it asked for in this turn
};

}  // namespace understudy::compositor
