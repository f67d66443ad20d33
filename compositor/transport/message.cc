// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/message.h"

#include <fmt/format.h>

#include <algorithm>

namespace understudy::compositor {

void check(const MessageHeader& header, Protocols spoken, std::uint64_t max_payload) {
  if (header.magic != message_magic) throw MalformedMessage("header: this is not a message of Understudy");
  const MessageType type = header.type;
  const auto protocol = std::ranges::find(spoken, type.protocol, &Protocol::number);
  if (protocol == spoken.end())
    throw MalformedMessage(
        fmt::format("header: protocol {} is not spoken here: use programs of one release", type.protocol));
  if (type.version != protocol->version)
    throw MalformedMessage(
        fmt::format("header: version {} of protocol {} instead of {}: use programs of one release",
                    type.version, type.protocol, protocol->version));
  if (type.number == 0 || type.number > protocol->last)
    throw MalformedMessage(
        fmt::format("header: unknown message type {} of protocol {}", type.number, type.protocol));
  if (header.payload_bytes > max_payload)
    throw MalformedMessage(
        fmt::format("header: payload of {} bytes, more than {}", header.payload_bytes, max_payload));
}

}  // namespace understudy::compositor
