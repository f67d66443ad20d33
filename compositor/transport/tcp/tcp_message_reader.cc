// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/tcp_message_reader.h"

#include <algorithm>
#include <utility>

#include "compositor/transport/limits.h"
#include "compositor/transport/tcp/line_protocol.h"

namespace understudy::compositor {

std::span<std::byte> TcpMessageReader::room() {
  switch (step_) {
    case Step::header:
      return std::as_writable_bytes(std::span(&header_, 1)).subspan(have_);
    case Step::block_head:
      return std::as_writable_bytes(std::span(&head_, 1)).subspan(have_);
    default:
      // Uncompressed blocks are read in place.
      return head_.codec() == 0 ? std::span(message_.payload).last(head_.bytes - have_)
                                : std::span(compressed_).subspan(have_);
  }
}

std::optional<Message> TcpMessageReader::took(std::size_t count) {
  have_ += count;
  if (!room().empty()) return std::nullopt;
  have_ = 0;
  switch (step_) {
    case Step::header:
      if (header_.type.as<LineMessage>())
        check(header_, line_protocols, 0);
      else
        check(header_, spoken_, max_payload_);
      step_ = Step::block_head;
      break;
    case Step::block_head:
      begin_block();
      return std::nullopt;
    default:
      return end_block();
  }
  if (header_.payload_bytes > 0) return std::nullopt;
  step_ = Step::header;
  return Message{header_.type, header_.sequence, {}, {}};
}

void TcpMessageReader::begin_block() {
  if (head_.bytes == 0 && head_.travels == 0) return;
  const std::uint64_t left = header_.payload_bytes - message_.payload.size();
  if (head_.bytes == 0 || head_.bytes > limits::max_tcp_block_bytes || head_.bytes > left)
    throw MalformedMessage("a block is longer than its message, or than blocks are");
  const bool plain = head_.codec() == 0;
  if (head_.codec() > unsigned(Codec::last) || head_.travelling() == 0 ||
      (plain ? head_.travelling() != head_.bytes : head_.travelling() >= head_.bytes))
    throw MalformedMessage("a block is compressed in no way that is known");
  // Memory grows with what arrives.
  message_.payload.resize(message_.payload.size() + head_.bytes);
  if (!plain) compressed_.resize(head_.travelling());
  step_ = Step::block;
}

std::optional<Message> TcpMessageReader::end_block() {
  if (head_.codec() != 0)
    decompress(Codec(head_.codec()), compressed_, std::span(message_.payload).last(head_.bytes));
  step_ = Step::block_head;
  if (message_.payload.size() < header_.payload_bytes) return std::nullopt;
  step_ = Step::header;
  message_.type = header_.type;
  message_.sequence = header_.sequence;
  return std::exchange(message_, {});
}

}  // namespace understudy::compositor
