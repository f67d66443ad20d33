// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/address.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace understudy::compositor {

namespace {

constexpr const char* this_machine = "127.0.0.1";

std::optional<std::uint16_t> port_of(const std::string& text) {
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || rest != end) return std::nullopt;
  return port;
}

}  // namespace

std::string TcpAddress::text() const {
  return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port)
                                             : fmt::format("[{}]:{}", host, port);
}

std::optional<TcpAddress> tcp_address_of(const std::string& text) {
  if (text.find('/') != std::string::npos) return std::nullopt;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) {
    const std::optional<std::uint16_t> port = port_of(text);
    return port ? std::optional(TcpAddress{this_machine, *port}) : std::nullopt;
  }
  std::string host = text.substr(0, colon);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (bracketed) host = host.substr(1, host.size() - 2);
  const std::optional<std::uint16_t> port = port_of(text.substr(colon + 1));
  if (!port || (!bracketed && host.find(':') != std::string::npos))
    throw std::runtime_error(fmt::format(
        "'{}' is no address; write host:port or [v6]:port, and a path with a / for a Unix socket", text));
  return TcpAddress{host.empty() ? this_machine : host, *port};
}

}  // namespace understudy::compositor
