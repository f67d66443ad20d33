// SPDX-License-Identifier: Apache-2.0
// Messages over one Unix socket. Never raises SIGPIPE, never waits longer than it is told to, and never reads
// beyond the message it returns (so that the socket can be passed to another process afterwards).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/limits.h"
#include "compositor/transport/message.h"
#include "compositor/transport/socket.h"

namespace understudy::compositor {

/// The peer is gone, or did not read or send a message in time. The text says which, as in "... closed the
/// connection".
class ConnectionLost : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Message {
  MessageType type{};
  std::uint64_t sequence = 0;
  std::vector<std::byte> payload;
  FileDescriptor attached;
};

using Bytes = std::span<const std::byte>;

class Connection {
 public:
  /// Accepts messages of the protocols `spoken`, which must outlive the connection.
  Connection(FileDescriptor socket, Protocols spoken, std::uint64_t max_payload = limits::max_message_bytes)
      : socket_(std::move(socket)), spoken_(spoken), max_payload_(max_payload) {}

  int fd() const { return socket_.get(); }

  /// Reads what is available; returns a message once it is complete. A long message needs several calls, so
  /// that one peer cannot keep the caller from the others. Throws ConnectionLost, and MalformedMessage: after
  /// either nothing more can be read.
  std::optional<Message> receive_some();
  /// Waits for a message. Throws ConnectionLost, also at the deadline.
  Message receive(Deadline deadline);
  /// For forwarding a message before all of it has arrived: returns its header, once that is complete; null
  /// before. Throws as receive_some(), which may be called for that message instead.
  const MessageHeader* receive_header();
  /// Reads some of the payload of the message of the last receive_header(). Returns how much; zero if nothing
  /// is available now. To be called until the payload is complete. Throws ConnectionLost.
  std::size_t receive_payload(std::span<std::byte> room);
  /// Whether the beginning of a message has arrived.
  bool unfinished() const { return received_ > 0; }
  /// Whether in addition nothing more of it has arrived for `patience`.
  bool stalled(std::chrono::milliseconds patience) const;

  /// Sends a header and the payload made of `parts`, with the descriptor `attach` unless that is -1. Throws
  /// ConnectionLost, also at the deadline; a deadline in the past means: now or never.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts, Deadline deadline,
            int attach = -1);
  void send(MessageType type, std::uint64_t sequence, Bytes payload, Deadline deadline, int attach = -1) {
    send(type, sequence, {&payload, 1}, deadline, attach);
  }
  /// Likewise, but throws ConnectionLost when nothing more could be sent for `patience`: all of a long message
  /// may take longer over a slow connection.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts,
            std::chrono::milliseconds patience, int attach = -1);

  /// The deadline for event loops: now or never.
  static Deadline now_or_never() { return {}; }

 private:
  std::size_t read(std::byte* to, std::size_t size);
  template <class DeadlineNow>
  void write(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts, int attach,
             DeadlineNow deadline_now);

  FileDescriptor socket_;
  Protocols spoken_;
  std::uint64_t max_payload_;
  MessageHeader header_;
  std::size_t received_ = 0;  ///< of header and payload together
  Deadline last_progress_{};
  Message message_;
};

}  // namespace understudy::compositor
