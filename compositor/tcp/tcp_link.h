// Messages over a TCP connection whose two ends have proved themselves (handshake.h). One thread may send while
// another receives.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "compositor/service/connection.h"
#include "compositor/tcp/address.h"
#include "compositor/tcp/block_codec.h"
#include "compositor/tcp/handshake.h"
#include "compositor/tcp/link_reader.h"

namespace understudy::compositor {

/// What a link has done in one direction.
struct LinkTraffic {
  std::atomic<std::uint64_t> messages = 0;
  std::atomic<std::uint64_t> payload_bytes = 0;  ///< of messages, as those who speak here see them
  std::atomic<std::uint64_t> bytes = 0;          ///< that travelled, heads among them
  std::array<std::atomic<std::uint64_t>, codec_count> blocks{};  ///< by how they were compressed
};

class TcpLink {
 public:
  TcpLink(FileDescriptor socket, std::uint64_t max_payload)
      : socket_(std::move(socket)), reader_(max_payload) {}

  int fd() const { return socket_.get(); }
  double bytes_per_second() const;

  /// Sends the payload made of `parts`. Throws ConnectionLost: the peer is gone, or has taken nothing for
  /// limits::link_patience.
  void send(MessageType type, std::uint64_t sequence, std::span<const Bytes> parts);
  /// Waits for a message as long as it takes for one to begin; within it the peer may not be silent for longer
  /// than limits::link_patience. Throws ConnectionLost and MalformedMessage.
  Message receive();

  const LinkTraffic& sent() const { return sent_; }
  const LinkTraffic& received() const { return received_; }

 private:
  void send_block(MessageType type, Bytes block, bool last);
  void write(std::span<const Bytes> pieces, bool more);

  FileDescriptor socket_;
  LinkReader reader_;
  LinkTraffic sent_;
  LinkTraffic received_;
  std::array<CodecChoice, std::size_t(MessageType::last) + 1> choices_;  ///< by what is sent
  BlockCompressor compressor_;
  std::vector<std::byte> compressed_;
};

/// Connects, and has both sides prove themselves. Throws std::runtime_error: what is wrong at `address`, and
/// what to do there.
FileDescriptor connect_link(const TcpAddress& address, const Secret& secret, const LinkWishes& wishes,
                            Deadline deadline);

}  // namespace understudy::compositor
