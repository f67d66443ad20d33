// SPDX-License-Identifier: Apache-2.0
// Forwards messages between a Unix socket of this machine and a connection over TCP, in both directions at
// once, until one of the two ends. There is a relay at each end of a connection; applications, node groups and
// GL servers never use TCP.
//
// Anything but bytes, such as a descriptor, stays on its machine: the relays for nodes (render_relay.h) and for
// a GL server handle it in carry_out() and carry_back().
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "compositor/transport/connection.h"
#include "compositor/transport/tcp/tcp_connection.h"

namespace understudy::compositor {

class Relay {
 public:
  /// Both must outlive the relay.
  Relay(Connection& here, TcpConnection& tcp) : here_(here), tcp_(tcp) {}
  virtual ~Relay() = default;
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  /// Returns when both directions have ended, shortly after the first of them. Returns why that one ended;
  /// empty if a peer left in an orderly way.
  std::string run();

 protected:
  /// Whether carry_out() gets this message from here even if it is long. Other long messages are forwarded as
  /// they arrive: applications wait until they have been sent, and connections may be slow.
  virtual bool needs_whole(const MessageType&) const { return false; }
  /// Forwards a message from here to the connection. On a thread of its own, like carry_back().
  virtual void carry_out(Message message);
  /// Forwards a message from the connection to here.
  virtual void carry_back(Message message);
  /// When rest() is called, if nothing comes from here until then.
  virtual Deadline rest_due() const;
  virtual void rest() {}

  void send_here(const Message& message, int attach = -1) { send_here(message, message.payload, attach); }
  void send_here(const Message& message, Bytes payload, int attach = -1);
  void send_tcp(const Message& message, std::span<const Bytes> parts) {
    tcp_.send(message.type, message.sequence, parts);
  }
  double line_bytes_per_second() const { return tcp_.bytes_per_second(); }

 private:
  void carry_next_out();
  void wait_for_here();
  void hand_on(const MessageHeader& header);

  Connection& here_;
  TcpConnection& tcp_;
  std::vector<std::byte> block_;
};

}  // namespace understudy::compositor
