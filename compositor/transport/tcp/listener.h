// SPDX-License-Identifier: Apache-2.0
// Where clients of other machines come in: a listening socket, whoever has come and not yet proved that it has
// the secret, and nothing else. Pending clients cost a descriptor each, have limits::hello_patience, and when
// there are more than limits::max_pending_clients the one that has got least far, of these the oldest, makes
// room.
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
  /// Whether a client with these wishes may come in.
  using Admission = std::function<AdmissionVerdict(const ConnectionRequest&)>;
  /// A client that was told that it may.
  using Accept = std::function<void(AuthenticatedSocket client, const ConnectionRequest& connection_request)>;

  /// `credentials` must outlive the listener. Who wants no encryption is only asked about where both ends are
  /// on this machine. `say` gets a line about who was not let in, at most one a second. Throws
  /// std::runtime_error where nobody can listen.
  Listener(const TcpAddress& address, const Credentials& credentials, Admission admission, Accept accept,
           Say say);
  Listener(const TcpAddress& address, const Credentials& credentials, Admission admission, Accept accept,
           Say say, const ListenerLimits& limits);

  /// With the port that was given if any would do.
  const TcpAddress& address() const { return address_; }
  std::size_t pending_clients() const { return pending_.size(); }

  /// Adds the descriptors to wait for.
  void poll_fds(std::vector<pollfd>& fds) const;
  /// When a pending client's time is up; the distant future without any.
  Deadline next_deadline() const;
  /// Handles what has happened, without waiting.
  void step();
  /// In a child process after fork(): closes all that it has inherited, without a word to anybody.
  void forget();

 private:
  struct PendingClient {
    FileDescriptor socket;
    Deadline until;
    ServerHandshake handshake;
    std::vector<std::byte> heard;  ///< of the message that is coming
    bool let_in = false;           ///< it has heard so
  };

  void accept_all();
  void make_room();
  /// False when the pending client is done with, one way or the other.
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
  std::size_t unsaid_ = 0;  ///< were dropped since the last line
};

}  // namespace understudy::compositor
