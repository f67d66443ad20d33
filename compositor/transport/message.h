// SPDX-License-Identifier: Apache-2.0
// The header that every message begins with, whatever its protocol.
//
// A protocol is an enum of messages (numbered from 1), with a number and a version of its own, in a header file
// of its own: compositor/service/{launcher,node,load}_protocol.h, spu/remote/gl_server_protocol.h,
// transport/tcp/line_protocol.h. Beside its enum it defines
//
//     constexpr Protocol protocol_of(NodeMessage) { return {2, 17, std::uint16_t(NodeMessage::last)}; }
//
// and its enumerators are then message types.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "compositor/transport/wire.h"

namespace understudy::compositor {

struct Protocol {
  std::uint8_t number = 0;   ///< unique
  std::uint8_t version = 0;  ///< grows with every change of a message
  std::uint16_t last = 0;    ///< the number of the last message
};

/// An enum whose enumerators are the messages of a protocol.
template <class Enum>
concept ProtocolMessage = requires(Enum message) {
  { protocol_of(message) } -> std::same_as<Protocol>;
};

/// A message type of some protocol, as in a header.
struct MessageType {
  std::uint8_t protocol = 0;
  std::uint8_t version = 0;
  std::uint16_t number = 0;

  constexpr MessageType() = default;
  /// Not explicit: a protocol's enumerators are message types.
  template <ProtocolMessage Enum>
  constexpr MessageType(Enum message)
      : protocol(protocol_of(message).number),
        version(protocol_of(message).version),
        number(std::uint16_t(message)) {}

  /// Returns the message, if it belongs to this protocol.
  template <ProtocolMessage Enum>
  constexpr std::optional<Enum> as() const {
    if (protocol != protocol_of(Enum{}).number) return std::nullopt;
    return Enum(number);
  }

  bool operator==(const MessageType&) const = default;
};

constexpr std::uint32_t message_magic = 0x59445355;  ///< "USDY"

struct MessageHeader {
  std::uint32_t magic = message_magic;
  MessageType type;
  std::uint64_t payload_bytes = 0;
  std::uint64_t sequence = 0;  ///< a reply has that of its request
};
static_assert(sizeof(MessageHeader) == 24);

using Protocols = std::span<const Protocol>;

/// Throws MalformedMessage unless magic and type are those of one of the protocols `spoken` and the payload is
/// no longer than `max_payload`.
void check(const MessageHeader& header, Protocols spoken, std::uint64_t max_payload);

}  // namespace understudy::compositor
