// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/peer.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace understudy::compositor {

uid_t peer_user(int socket) {
  ucred credentials{};
  socklen_t size = sizeof credentials;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &credentials, &size) != 0)
    throw std::runtime_error(fmt::format("cannot find out who is at a socket: {}", std::strerror(errno)));
  return credentials.uid;
}

bool is_of_same_user(int socket) {
  return peer_user(socket) == ::geteuid();
}

void require_listener_of(uid_t wanted, int socket, const std::string& path) {
  const uid_t found = peer_user(socket);
  if (found == wanted) return;
  throw ForeignListener(
      fmt::format("user {} listens at '{}', not user {}: nothing was sent there; name a socket of your own",
                  found, path, wanted));
}

}  // namespace understudy::compositor
