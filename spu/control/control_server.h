// SPDX-License-Identifier: Apache-2.0
// Answers requests of this user on a Unix socket, on a thread of its own (control_message.h).
//
// Whatever is sent there, the process goes on: lines are limited in length, a connection has to be quick, there
// are few of them, and the thread handles no signals.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <string_view>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"

namespace understudy::spu {

constexpr std::size_t max_control_connections = 8;  ///< the oldest is closed for another one
/// From accept, or from the last answer, to a whole request, and until its answer has been read.
constexpr std::chrono::seconds control_patience{5};

class ControlServer {
 public:
  /// Returns the line that answers a request's line, which is given without its end. Is called on the server's
  /// thread, and may throw: the connection is closed then.
  using Answer = std::function<std::string(std::string_view line)>;

  /// Listens at `socket`. Throws std::runtime_error (what is wrong with the path) and std::system_error (no
  /// thread can be started).
  ControlServer(const std::filesystem::path& socket, Answer answer);
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;
  ~ControlServer();

  /// Removes the socket, and its folder if it was the last one there, and ends the thread. Returns after
  /// `patience` even if the thread still answers, which then ends later. Allocates and frees nothing: the
  /// program may call exit() in a signal handler.
  void stop(std::chrono::milliseconds patience) noexcept;

  /// Called in a forked child, which must not answer for its parent: lets go of the socket. Only the forking
  /// thread exists then, and the child must not use the server otherwise.
  void leave_to_parent() noexcept;

 private:
  struct Connection {
    compositor::FileDescriptor socket;
    std::string received;
    std::string answer;
    std::size_t sent = 0;
    compositor::Deadline deadline;
  };

  void serve();
  /// Waits for the sockets, and for the first deadline.
  void wait();
  void accept();
  /// Returns false if the connection is to be closed.
  bool proceed(Connection& connection, short events);
  bool receive(Connection& connection);
  bool send(Connection& connection);
  void answer_next_line(Connection& connection);

  const std::string path_;
  const std::string folder_;
  const Answer answer_;
  compositor::FileDescriptor listener_;
  std::atomic<int> listener_fd_ = -1;  ///< also for a forked child, in which listener_ may not be used
  compositor::FileDescriptor wake_;
  std::array<std::optional<Connection>, max_control_connections> connections_;
  compositor::Deadline accepts_from_{};  ///< later if the process has no descriptor left
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> serves_ = true;  ///< false once the thread has ended
  std::future<void> end_;            ///< of the thread
};

}  // namespace understudy::spu
