// SPDX-License-Identifier: Apache-2.0
// Carries messages between a Unix socket of this machine and a connection over TCP, both ways at once, until
// one of the two ends. There is one at each end of a connection; applications, node groups and GL servers know
// nothing of TCP.
//
// What is not bytes, as a descriptor, stays on its machine: who carries for nodes (render_relay.h) or for a
// GL server says in the two functions below what becomes of it.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "compositor/transport/connection.h"
#include "compositor/transport/tcp/tcp_connection.h"

namespace understudy::compositor {

class Relay {
 public:
  /// Both must outlive it.
  Relay(Connection& here, TcpConnection& tcp) : here_(here), tcp_(tcp) {}
  virtual ~Relay() = default;
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  /// Returns when both directions have ended: a moment after the first of them. Why that did, if not because
  /// somebody left in an orderly way; else empty.
  std::string run();

 protected:
  /// Whether carry_out() is to get this message from here even if it is long. Other long messages are handed on
  /// as they come: applications wait until they have left, and lines may be slow.
  virtual bool needs_whole(const MessageType&) const { return false; }
  /// What came from here, and goes to the connection. On a thread of its own, as the next.
  virtual void carry_out(Message message);
  /// The other way.
  virtual void carry_back(Message message);
  /// When rest() is called if nothing comes from here until then.
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
