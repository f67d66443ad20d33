// SPDX-License-Identifier: Apache-2.0
// Messages over a TCP connection whose two ends are authenticated (handshake.h), in encrypted records
// (record.h) unless both ends chose none. One thread may send while another receives.
//
// A peer may be busy for long and read nothing (a GL server in a call, a node with a volume), which looks like
// a cut connection. So an end that sends nothing else sends signs of life, and a silent end is considered gone.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "compositor/transport/connection.h"
#include "compositor/transport/tcp/address.h"
#include "compositor/transport/tcp/authenticated_socket.h"
#include "compositor/transport/tcp/block_codec.h"
#include "compositor/transport/tcp/handshake.h"
#include "compositor/transport/tcp/record_opener.h"
#include "compositor/transport/tcp/record_sealer.h"
#include "compositor/transport/tcp/tcp_message_reader.h"

namespace understudy::compositor {

/// What a connection has carried in one direction.
struct TcpTraffic {
  std::atomic<std::uint64_t> messages = 0;
  std::atomic<std::uint64_t> payload_bytes = 0;                  ///< of messages, before compression
  std::atomic<std::uint64_t> bytes = 0;                          ///< that were sent, heads included
  std::array<std::atomic<std::uint64_t>, codec_count> blocks{};  ///< by codec
};

/// The connection is cut, or the process at its other end has stopped.
class ConnectionAbandoned : public ConnectionLost {
 public:
  using ConnectionLost::ConnectionLost;
};

class TcpConnection {
 public:
  /// Accepts messages of the protocols `spoken`, which must outlive the connection. A peer that is silent for
  /// `patience` is considered gone.
  TcpConnection(AuthenticatedSocket peer, Protocols spoken, std::uint64_t max_payload,
                std::chrono::milliseconds patience = limits::connection_patience);

  int fd() const { return socket_.get(); }
  double bytes_per_second() const;

  /// Sends the payload made of `parts`. Throws ConnectionLost if the peer has gone, and ConnectionAbandoned if
  /// it is silent or has read nothing for limits::server_patience.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts);
  /// Begins a message whose payload follows in calls of send_payload(), as it arrives. Nothing else may be sent
  /// until the payload is complete.
  void begin(MessageType type, std::uint64_t sequence, std::uint64_t payload_bytes);
  void send_payload(Bytes some);
  /// Sends a sign of life, also within a message. Due at alive_due() if nothing else is sent until then.
  void send_alive();
  Deadline alive_due() const { return sent_at_ + patience_ / 4; }
  /// Waits for a message as long as the peer sends signs of life. Throws ConnectionAbandoned, ConnectionLost
  /// and MalformedMessage.
  Message receive();

  const TcpTraffic& sent() const { return sent_; }
  const TcpTraffic& received() const { return received_; }

 private:
  void send_block(MessageType type, Bytes block, bool last);
  void write(std::span<const Bytes> pieces, bool more);
  void write_records(std::span<const Bytes> pieces, bool more);
  void write_gathered(bool more);
  void write_as_they_are(std::span<const Bytes> pieces, bool more);
  std::span<std::byte> room();
  std::optional<Message> took(std::size_t count);
  std::optional<Message> take_opened();
  void wait_for_room();
  bool peer_is_silent() const;
  [[noreturn]] void give_up_silent_line() const;

  FileDescriptor socket_;
  std::chrono::milliseconds patience_;
  std::optional<RecordSealer> sealer_;
  std::optional<RecordOpener> opener_;
  std::vector<std::byte> gathered_;  ///< for the next record
  std::vector<std::byte> opened_;    ///< a record in which messages end and begin
  std::size_t taken_ = 0;            ///< how much of opened_ was read
  TcpMessageReader reader_;
  MessageType begun_{};
  std::uint64_t begun_left_ = 0;  ///< bytes of that message that are still to be sent
  Deadline sent_at_ = Clock::now();
  std::atomic<Deadline> heard_at_ = Clock::now();
  TcpTraffic sent_;
  TcpTraffic received_;
  std::map<std::pair<std::uint8_t, std::uint16_t>, CodecChoice> choices_;  ///< by message type
  BlockCompressor compressor_;
  std::vector<std::byte> compressed_;
};

/// Connects, and authenticates both sides. Throws std::runtime_error: what is wrong at `address`, and what to
/// do there.
AuthenticatedSocket connect_tcp(const TcpAddress& address, const Credentials& credentials,
                                const ConnectionRequest& connection_request, Deadline deadline);

}  // namespace understudy::compositor
