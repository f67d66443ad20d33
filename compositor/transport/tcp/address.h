// SPDX-License-Identifier: Apache-2.0
// Where a service is found: at a Unix socket of this machine, or at a host and a port.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace understudy::compositor {

struct TcpAddress {
  std::string host;  ///< a name or a number, without brackets
  std::uint16_t port = 0;

  /// As users write it: "host:port", "[v6]:port".
  std::string text() const;
};

/// Parses "host:port" or "[v6]:port"; ":port" and "port" mean this machine alone (127.0.0.1). Returns null for
/// the path of a Unix socket, which has a '/' or no colon. Throws std::runtime_error for anything else, with
/// what to write instead.
std::optional<TcpAddress> tcp_address_of(const std::string& text);

}  // namespace understudy::compositor
