// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/tcp_socket.h"

#include <fmt/format.h>
#include <linux/tcp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "compositor/transport/limits.h"

namespace understudy::compositor {

namespace {

using AddressList = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

AddressList resolve(const TcpAddress& address, int flags) {
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = flags | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error =
          ::getaddrinfo(address.host.c_str(), std::to_string(address.port).c_str(), &wanted, &found);
      error != 0)
    throw std::runtime_error(
        fmt::format("'{}' is no host that is known here: {}", address.host, ::gai_strerror(error)));
  return {found, &::freeaddrinfo};
}

void set(int socket, int level, int option, int value) {
  // If a kernel lacks one of these, connections are only slower to notice a cut.
  ::setsockopt(socket, level, option, &value, sizeof value);
}

/// Connects without blocking; returns 0, or errno's reason.
int try_to_connect(int socket, const addrinfo& to, Deadline deadline) {
  if (::connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (!wait_until_ready(socket, POLLOUT, deadline)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  return ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

TcpAddress address_of(int socket, decltype(&::getpeername) name) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  char host[NI_MAXHOST] = {};
  char port[NI_MAXSERV] = {};
  auto* const address = reinterpret_cast<sockaddr*>(&storage);
  if (name(socket, address, &size) != 0 ||
      ::getnameinfo(address, size, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return {"somebody who has left", 0};
  return {host, std::uint16_t(std::stoi(port))};
}

bool is_loopback(int socket, decltype(&::getpeername) name) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (name(socket, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return false;
  constexpr std::uint8_t loopback_net = 127;
  if (storage.ss_family == AF_INET) {
    const auto& address = reinterpret_cast<const sockaddr_in&>(storage).sin_addr;
    return ::ntohl(address.s_addr) >> 24 == loopback_net;
  }
  if (storage.ss_family != AF_INET6) return false;
  const in6_addr& address = reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(&address) ||
         (IN6_IS_ADDR_V4MAPPED(&address) && address.s6_addr[12] == loopback_net);
}

}  // namespace

void set_connection_options(int socket) {
  set(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  // The sender then sees how fast the connection takes bytes, not how fast memory is filled.
  set(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, int(limits::max_tcp_block_bytes));
  // A peer that has gone is detected by its silence (tcp_connection.h). The kernel's own time-out also ends
  // connections to a peer that only reads nothing for a while, and must come later.
  set(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, int(2 * limits::server_patience.count()));
}

FileDescriptor listen_at(const TcpAddress& address) {
  const AddressList list = resolve(address, AI_PASSIVE);
  FileDescriptor result(::socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (result) set(result.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  if (!result || ::bind(result.get(), list->ai_addr, list->ai_addrlen) != 0 ||
      ::listen(result.get(), SOMAXCONN) != 0)
    throw std::runtime_error(
        fmt::format("cannot listen at '{}': {}; name an address of this machine and a port that is free",
                    address.text(), std::strerror(errno)));
  return result;
}

TcpAddress own_address(int socket) {
  return address_of(socket, &::getsockname);
}

TcpAddress peer_address(int socket) {
  return address_of(socket, &::getpeername);
}

bool is_within_machine(int socket) {
  return is_loopback(socket, &::getsockname) && is_loopback(socket, &::getpeername);
}

FileDescriptor connect_to(const TcpAddress& address, Deadline deadline) {
  const AddressList list = resolve(address, 0);
  int error = 0, left = 0;
  for (const addrinfo* to = list.get(); to != nullptr; to = to->ai_next) ++left;
  for (const addrinfo* to = list.get(); to != nullptr; to = to->ai_next, --left) {
    FileDescriptor result(::socket(to->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!result) {
      error = errno;  // this kernel may lack the address's family, and not that of the next address
      continue;
    }
    // An address whose packets vanish must leave time for the addresses after it.
    const Deadline now = Clock::now();
    error = try_to_connect(result.get(), *to, now + (deadline - now) / left);
    if (error != 0) continue;
    set_connection_options(result.get());
    return result;
  }
  throw std::runtime_error(fmt::format("cannot connect to '{}': {}", address.text(), std::strerror(error)));
}

LineFigures line_figures(int socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return {};
  LineFigures figures;
  figures.round_trip_ms = double(info.tcpi_rtt) / 1000;
  if (size >= offsetof(tcp_info, tcpi_delivery_rate) + sizeof info.tcpi_delivery_rate)
    figures.bytes_per_second = double(info.tcpi_delivery_rate);
  return figures;
}

}  // namespace understudy::compositor
