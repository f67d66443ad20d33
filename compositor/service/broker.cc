// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/broker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "compositor/logging/log.h"
#include "compositor/service/service_protocols.h"

namespace understudy::compositor {

namespace {

void send_away(Connection& client, const std::string& reason) {
  try {
    client.send(LauncherMessage::refused, 0, encode_text(reason), Connection::now_or_never());
  } catch (const ConnectionLost&) {
    // The client is leaving anyway.
  }
}

// Whether something arrived on a connection that should be quiet, or the connection ended.
bool stirs(const Connection& connection) {
  return wait_until_ready(connection.fd(), POLLIN | POLLRDHUP, Connection::now_or_never());
}

}  // namespace

Broker::Broker(const BrokerSockets& sockets, Say say, const BrokerPatience& patience)
    : say_(std::move(say)), patience_(patience), applications_(sockets.applications), group_(sockets.nodes) {
  if (!say_) say_ = [](const std::string& line) { logging::log(logging::Level::info, "{}", line); };
}

void Broker::poll_fds(std::vector<pollfd>& fds) const {
  if (Clock::now() >= accept_again_) {
    for (const Entrance* entrance : {&group_, &applications_})
      fds.push_back({entrance->listener.get(), POLLIN, 0});
  }
  for (const Peer& peer : newcomers_) fds.push_back({peer.connection.fd(), POLLIN, 0});
  for (const Connection& client : waiting_) fds.push_back({client.fd(), POLLIN | POLLRDHUP, 0});
  for (const Connection& nodes : nodes_) fds.push_back({nodes.fd(), POLLIN | POLLRDHUP, 0});
}

void Broker::step(std::chrono::milliseconds timeout) {
  std::vector<pollfd> fds;
  poll_fds(fds);
  // Errors and signals are ignored: the handlers below find out by themselves what there is to do.
  ::poll(fds.data(), fds.size(), int(timeout.count()));
  hear_nodes();  // first: a dead group must not keep its successor out
  accept_all(group_);
  accept_all(applications_);
  hear_newcomers();
  hear_waiting();
  hand_over();
}

void Broker::accept_all(const Entrance& entrance) {
  while (Clock::now() >= accept_again_) {
    FileDescriptor peer = accept_from(entrance.listener);
    if (!peer) {
      if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED) return;
      // Out of descriptors or memory: the connection stays in the queue, and retrying at once would spin.
      say_(fmt::format("cannot accept a connection at '{}': {}; trying again in a second", entrance.path(),
                       std::strerror(errno)));
      accept_again_ = Clock::now() + std::chrono::seconds(1);
      return;
    }
    Connection connection(std::move(peer), service_protocols, limits::max_hello_bytes);
    // Nodes are accepted however many applications there are.
    if (&entrance == &applications_ && newcomers_.size() + waiting_.size() >= limits::max_clients) {
      send_away(connection, fmt::format("{} applications already wait for a node group", limits::max_clients));
      continue;
    }
    newcomers_.push_back({std::move(connection), Clock::now() + patience_.hello, &entrance});
  }
}

void Broker::hear_newcomers() {
  std::vector<Peer> still_new;
  for (Peer& peer : newcomers_) {
    const std::string& entrance = peer.entrance->path();
    try {
      if (const std::optional<Message> hello = peer.connection.receive_some())
        accepted(std::move(peer), *hello);
      else if (Clock::now() < peer.hello_until)
        still_new.push_back(std::move(peer));
      else
        say_(fmt::format("dropped a connection at '{}' that did not say what it is", entrance));
    } catch (const ConnectionLost& error) {
      // A peer that connects and leaves without a message only checked whether somebody listens.
      if (peer.connection.unfinished())
        say_(fmt::format("dropped a connection at '{}': {}", entrance, error.what()));
    } catch (const std::runtime_error& error) {
      say_(fmt::format("dropped a connection at '{}': {}", entrance, error.what()));
    }
  }
  newcomers_ = std::move(still_new);
}

void Broker::accepted(Peer peer, const Message& hello) {
  const bool is_group = hello.type == LauncherMessage::hello_nodes;
  if (is_group != (peer.entrance == &group_))
    throw MalformedMessage(is_group ? "wants to be the nodes" : "its first message is no hello of nodes");
  if (is_group) {
    const int ranks = decode_hello(hello.payload).ranks;
    if (!nodes_.empty()) return say_(fmt::format("sent a second node group of {} ranks away", ranks));
    nodes_.push_back(std::move(peer.connection));
    nodes_heard_at_ = Clock::now();
    ranks_ = ranks;
    lost_ = false;
    turned_away_.clear();
  } else if (hello.type == LauncherMessage::hello_client) {
    if (turned_away_.empty())
      waiting_.push_back(std::move(peer.connection));
    else
      send_away(peer.connection, turned_away_);
  } else {
    throw MalformedMessage("its first message is no hello");
  }
}

void Broker::hear_waiting() {
  // A waiting application sends nothing until it is accepted: otherwise it has gone, or violates the protocol.
  std::erase_if(waiting_, [](const Connection& client) { return stirs(client); });
}

void Broker::hear_nodes() {
  if (nodes_.empty()) return;
  try {
    // Reads all messages first: this process may have been delayed itself.
    while (const std::optional<Message> message = nodes_.front().receive_some()) {
      if (message->type != LauncherMessage::alive) return lose_nodes("rank 0 spoke out of turn");
      nodes_heard_at_ = Clock::now();
      const std::chrono::milliseconds unwanted(decode_alive(message->payload).unwanted_ms);
      if (unwanted > patience_.unwanted)
        return lose_nodes(fmt::format("they hang: a request is not done {} s after its application left",
                                      std::chrono::duration_cast<std::chrono::seconds>(unwanted).count()));
    }
  } catch (const ConnectionLost&) {
    return lose_nodes("the node group closed its connection");
  } catch (const MalformedMessage& error) {
    return lose_nodes(error.what());
  }
  if (Clock::now() > nodes_heard_at_ + patience_.silence)
    lose_nodes(fmt::format("they hang: rank 0 has said nothing for {} s",
                           std::chrono::duration_cast<std::chrono::seconds>(patience_.silence).count()));
}

void Broker::hand_over() {
  while (!nodes_.empty() && !waiting_.empty()) {
    try {
      nodes_.front().send(LauncherMessage::client, 0, Bytes{}, Connection::now_or_never(),
                          waiting_.front().fd());
    } catch (const ConnectionLost&) {
      // Busy: the next step tries again, and finds out whether the group has gone.
      return;
    }
    waiting_.erase(waiting_.begin());
    ++handed_over_;
  }
}

void Broker::lose_nodes(const std::string& why) {
  nodes_.clear();
  lost_ = true;
  say_(why);
}

void Broker::dismiss_node_group() {
  nodes_.clear();
}

void Broker::turn_away(const std::string& reason) {
  turned_away_ = reason;
  for (Connection& client : waiting_) send_away(client, reason);
  waiting_.clear();
}

}  // namespace understudy::compositor
