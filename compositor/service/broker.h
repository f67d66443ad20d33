// SPDX-License-Identifier: Apache-2.0
// The launcher's side of the render service, where a node group and the applications meet. Each has a socket of
// its own, so that a process with an application's connection cannot pose as the nodes.
//
// The broker outlives node groups, because MPI ends a whole job when one rank dies. Applications that connect
// while there is no group are held. When rank 0 of a group has sent its hello, it gets their connections
// (SCM_RIGHTS); from then on application and rank 0 communicate without the launcher. Rank 0 then sends the
// launcher a message once a second. A group that stops doing so, or that does not finish a request whose
// application has gone, is considered hung and is given up.
#pragma once

#include <poll.h>

#include <functional>
#include <string>
#include <vector>

#include "compositor/service/limits.h"
#include "compositor/transport/connection.h"
#include "compositor/transport/socket_file.h"

namespace understudy::compositor {

/// How long the launcher waits before it gives up a peer.
struct BrokerPatience {
  std::chrono::milliseconds hello = limits::hello_patience;
  std::chrono::milliseconds silence = limits::silence_patience;
  std::chrono::milliseconds unwanted = limits::unwanted_patience;
};

struct BrokerSockets {
  std::string applications;
  std::string nodes;
};

class Broker {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Listens at both paths (mode 0600). `say` gets one line for everything that goes wrong later; by default
  /// the line is logged. Throws std::runtime_error if a path is taken or cannot be used.
  explicit Broker(const BrokerSockets& sockets, Say say = {}, const BrokerPatience& patience = {});
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  /// Adds the descriptors to wait for, for a caller with a poll loop of its own, which then calls step(0).
  void poll_fds(std::vector<pollfd>& fds) const;
  /// Waits at most `timeout` for events and handles all that have happened.
  void step(std::chrono::milliseconds timeout);

  bool node_group_ready() const { return !nodes_.empty(); }
  /// How many ranks the group has; 0 without a group.
  int ranks() const { return nodes_.empty() ? 0 : ranks_; }
  /// Whether a node group has died or hangs, and another must be started. False again after the next group's
  /// hello.
  bool lost() const { return lost_; }
  /// Asks the group to end: its applications lose their connections. lost() does not change.
  void dismiss_node_group();

  /// To be called when no group will come (MPI is missing, it keeps dying): refuses all waiting and later
  /// applications with `reason`, until a group sends its hello after all.
  void turn_away(const std::string& reason);

  std::size_t clients_waiting() const { return waiting_.size(); }
  std::size_t clients_handed_over() const { return handed_over_; }

 private:
  struct Entrance {
    explicit Entrance(const std::string& path) : listener(listen_at(path)), file(path) {}
    const std::string& path() const { return file.path(); }

    FileDescriptor listener;
    SocketFile file;
  };
  struct Peer {
    Connection connection;
    Deadline hello_until;
    const Entrance* entrance;  ///< at which it connected
  };

  void accept_all(const Entrance& entrance);
  void hear_newcomers();
  void hear_waiting();
  void hear_nodes();
  void accepted(Peer peer, const Message& hello);
  void hand_over();
  void lose_nodes(const std::string& why);

  Say say_;
  BrokerPatience patience_;
  Entrance applications_;
  Entrance group_;
  Deadline accept_again_{};
  std::vector<Peer> newcomers_;      // have not sent a hello yet
  std::vector<Connection> waiting_;  // applications
  std::vector<Connection> nodes_;    // the group: one or none
  Deadline nodes_heard_at_{};
  int ranks_ = 0;
  bool lost_ = false;
  std::string turned_away_;
  std::size_t handed_over_ = 0;
};

}  // namespace understudy::compositor
