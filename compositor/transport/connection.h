// SPDX-License-Identifier: Apache-2.0
// Messages over one Unix socket. Never raises SIGPIPE, never waits longer than it was told to, never reads
// beyond the message it returns (so that the socket can be handed to another process afterwards).
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

/// The peer is gone, or did not take or give a message in time. The text says which, as in "... closed the
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

  /// Takes what is there; a message once it is complete. A long message needs several calls, so that one peer
  /// cannot keep the caller from the others. Throws ConnectionLost, and MalformedMessage: after either nothing
  /// more can be read.
  std::optional<Message> receive_some();
  /// Throws ConnectionLost, also at the deadline.
  Message receive(Deadline deadline);
  /// For who hands on a message before all of it is here: its header, once that has come; null before. Throws
  /// as receive_some(), which may take that message as well.
  const MessageHeader* receive_header();
  /// Some of the payload of that message, which begins at the last receive_header(); how much it was, and zero
  /// when nothing is there now. To be called until it has come whole. Throws ConnectionLost.
  std::size_t receive_payload(std::span<std::byte> room);
  /// The beginning of a message is here.
  bool unfinished() const { return received_ > 0; }
  /// And nothing more of it has come for `patience`.
  bool stalled(std::chrono::milliseconds patience) const;

  /// Sends a header and the payload made of `parts`, with a descriptor attached when `attach` is one. Throws
  /// ConnectionLost, also at the deadline; a deadline that has passed means: now or never.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts, Deadline deadline,
            int attach = -1);
  void send(MessageType type, std::uint64_t sequence, Bytes payload, Deadline deadline, int attach = -1) {
    send(type, sequence, {&payload, 1}, deadline, attach);
  }
  /// The same, and throws ConnectionLost when nothing more of it left for `patience`: a long message may be on
  /// its way for longer, as lines may be slow.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts,
            std::chrono::milliseconds patience, int attach = -1);

  /// What an event loop sends: now or never.
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
