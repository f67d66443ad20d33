// SPDX-License-Identifier: Apache-2.0
// Makes messages of the bytes of a connection over TCP.
//
// A message over TCP is the header of message.h, then its payload in blocks. A block begins with its size
// before compression (at most limits::max_tcp_block_bytes) and, in the next four bytes, its size as sent (low
// 24 bits) and its codec (high 8 bits). An empty block is a sign of life from a sender that waits for the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compositor/transport/connection.h"
#include "compositor/transport/tcp/block_codec.h"

namespace understudy::compositor {

struct BlockHead {
  std::uint32_t bytes = 0;
  std::uint32_t travels = 0;

  static BlockHead of(std::size_t bytes, std::size_t travelling, Codec codec) {
    return {std::uint32_t(bytes), std::uint32_t(travelling) | std::uint32_t(codec) << 24};
  }
  std::size_t travelling() const { return travels & 0xffffff; }
  unsigned codec() const { return travels >> 24; }
};
static_assert(sizeof(BlockHead) == 8);

class TcpMessageReader {
 public:
  /// Accepts messages of the protocols `spoken`, which must outlive the reader, and of line_protocol.h.
  TcpMessageReader(Protocols spoken, std::uint64_t max_payload) : spoken_(spoken), max_payload_(max_payload) {}

  /// Where the next bytes belong; never empty.
  std::span<std::byte> room();
  /// The first `count` bytes of room() have been filled. Returns the message that they complete, if any. Throws
  /// MalformedMessage: nothing more can be read then.
  std::optional<Message> took(std::size_t count);
  /// Whether the beginning of a message has arrived.
  bool unfinished() const { return step_ != Step::header || have_ > 0; }

 private:
  enum class Step { header, block_head, block };

  void begin_block();
  std::optional<Message> end_block();

  Protocols spoken_;
  std::uint64_t max_payload_;
  Step step_ = Step::header;
  std::size_t have_ = 0;  ///< bytes of the part being read
  MessageHeader header_;
  BlockHead head_;
  std::vector<std::byte> compressed_;
  Message message_;
};

}  // namespace understudy::compositor
