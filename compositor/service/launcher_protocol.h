// SPDX-License-Identifier: Apache-2.0
// Messages from applications and node groups to the launcher, which passes applications on to the nodes; and
// how an application is accepted or refused, there and by GL servers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compositor/transport/message.h"

namespace understudy::compositor {

enum class LauncherMessage : std::uint16_t {
  // to the launcher, and from it to a node group
  hello_client = 1,
  hello_nodes,  ///< payload: Hello
  client,       ///< attached: the connection of an application
  // replies
  accepted,  ///< payload: Hello
  refused,   ///< payload: the reason; also the reply to any later request
  // from rank 0 to the launcher, once a second
  alive,  ///< payload: Alive
  last = alive
};

constexpr Protocol protocol_of(LauncherMessage) {
  return {1, 20, std::uint16_t(LauncherMessage::last)};
}

struct Hello {
  int ranks = 0;
};

/// How long rank 0 has worked on a request whose application has gone; at most limits::max_unwanted_ms.
struct Alive {
  int unwanted_ms = 0;
};

std::vector<std::byte> encode(const Hello& hello);
std::vector<std::byte> encode(const Alive& alive);
std::vector<std::byte> encode_text(const std::string& text);  ///< truncated to limits::max_text_bytes

// All of these throw MalformedMessage. Decoded values are within limits.h.
Hello decode_hello(std::span<const std::byte> payload);
Alive decode_alive(std::span<const std::byte> payload);
std::string decode_text(std::span<const std::byte> payload);

}  // namespace understudy::compositor
