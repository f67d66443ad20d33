// SPDX-License-Identifier: Apache-2.0
// Accepts clients of other machines: a listening socket, and the clients that have connected and not yet proved
// that they have the secret. Each pending client holds a descriptor for at most limits::hello_patience. Above
// limits::max_pending_clients the oldest is closed.
#pragma once

#include <poll.h>

#include <functional>
#include <string>
#include <vector>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/tcp/address.h"
#include "compositor/transport/tcp/authenticated_socket.h"
#include "compositor/transport/tcp/handshake.h"

namespace understudy::compositor {

struct ListenerLimits {
  std::chrono::milliseconds patience;  ///< from accept to a complete proof
  std::size_t pending_clients;
};

class Listener {
 public:
  using Say = std::function<void(const std::string&)>;
  /// Decides whether a client with this request is accepted.
  using Admission = std::function<AdmissionVerdict(const ConnectionRequest&)>;
  /// Receives a client that has been told that it is accepted.
  using Accept = std::function<void(AuthenticatedSocket client, const ConnectionRequest& connection_request)>;

  /// `credentials` must outlive the listener. A client that requests no encryption is passed to `admission`
  /// only if both ends are on this machine. `say` gets a line about clients that were not accepted, at most one
  /// a second. Throws std::runtime_error if it cannot listen.
  Listener(const TcpAddress& address, const Credentials& credentials, Admission admission, Accept accept,
           Say say);
  Listener(const TcpAddress& address, const Credentials& credentials, Admission admission, Accept accept,
           Say say, const ListenerLimits& limits);

  /// With the actual port, if any port would do.
  const TcpAddress& address() const { return address_; }
  std::size_t pending_clients() const { return pending_.size(); }

  /// Adds the descriptors to wait for.
  void poll_fds(std::vector<pollfd>& fds) const;
  /// When the next pending client's time is up; far in the future if there is none.
  Deadline next_deadline() const;
  /// Handles what has happened, without waiting.
  void step();
  /// In a child process after fork(): closes all inherited sockets without sending anything.
  void forget();

 private:
  struct PendingClient {
    FileDescriptor socket;
    Deadline until;
    ServerHandshake handshake;
    std::vector<std::byte> heard;  ///< of the message that is arriving
    bool let_in = false;           ///< it has been told so
  };

  void accept_all();
  void make_room();
  /// Returns false when the client is no longer pending, accepted or not.
  bool hear(PendingClient& pending);
  AdmissionVerdict verdict_on(const PendingClient& pending) const;
  void drop(const PendingClient& pending, const std::string& why);

  const Credentials& credentials_;
  Admission admission_;
  Accept accept_;
  Say say_;
  ListenerLimits limits_;
  FileDescriptor socket_;
  TcpAddress address_;
  std::vector<PendingClient> pending_;  ///< the oldest first
  Deadline accept_again_{};
  Deadline say_again_{};
  std::size_t unsaid_ = 0;  ///< clients dropped since the last line
};

}  // namespace understudy::compositor
