// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/socket.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "compositor/transport/connector.h"
#include "compositor/transport/peer.h"

namespace understudy::compositor {

namespace {

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  constexpr std::size_t longest = sizeof address.sun_path - 1;
  if (path.empty() || path.size() > longest)
    throw std::runtime_error(
        fmt::format("'{}' cannot name a socket: 1 to {} characters are possible", path, longest));
  std::memcpy(address.sun_path, path.data(), path.size());
  return address;
}

FileDescriptor new_socket() {
  FileDescriptor result(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!result) throw std::runtime_error(fmt::format("cannot make a socket: {}", std::strerror(errno)));
  return result;
}

[[noreturn]] void cannot_listen(const std::string& path) {
  throw std::runtime_error(fmt::format("cannot listen at '{}': {}: name a path in a folder that is yours", path,
                                       std::strerror(errno)));
}

/// Returns a path beside `path`, with a name that nobody can guess.
std::string name_beside(const std::string& path) {
  std::uint32_t random = 0;
  if (::getrandom(&random, sizeof random, 0) != ssize_t(sizeof random)) cannot_listen(path);
  return std::filesystem::path(path).replace_filename(fmt::format(".{:08x}", random));
}

int try_to_connect(int fd, const sockaddr_un& address) {
  return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
}

/// Throws if the path is taken.
void remove_dead_socket(const std::string& path) {
  const sockaddr_un address = address_of(path);
  struct stat existing {};
  if (::lstat(path.c_str(), &existing) != 0) return;
  if (!S_ISSOCK(existing.st_mode))
    throw std::runtime_error(fmt::format("'{}' exists and is no socket: name another path", path));
  if (existing.st_uid != ::geteuid())
    throw std::runtime_error(fmt::format("'{}' is another user's socket: name another path", path));
  if (try_to_connect(new_socket().get(), address) != ECONNREFUSED)
    throw std::runtime_error(fmt::format("'{}' is in use by another launcher: name another path", path));
  ::unlink(path.c_str());
}

}  // namespace

bool wait_until_ready(int fd, short events, Deadline deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd entry{fd, events, 0};
    const int ready = ::poll(&entry, 1, int(std::clamp<long long>(left, 0, 1 << 30)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("poll failed: {}", std::strerror(errno)));
    if (left <= 0) return false;
  }
}

FileDescriptor listen_at(const std::string& path) {
  remove_dead_socket(path);
  FileDescriptor result = new_socket();
  // A socket that has a name refuses connections until somebody listens on it, just like one whose listener has
  // gone. So it gets its name only then.
  const std::string unfinished = name_beside(path);
  const sockaddr_un address = address_of(unfinished);
  // On Linux the socket's own mode becomes that of its file, so there is no moment in which others may connect.
  ::fchmod(result.get(), 0600);
  if (::bind(result.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    cannot_listen(path);
  // A hard link, unlike a rename, replaces no other file.
  const bool listens = ::listen(result.get(), SOMAXCONN) == 0 && ::link(unfinished.c_str(), path.c_str()) == 0;
  const int reason = errno;
  ::unlink(unfinished.c_str());
  errno = reason;
  if (!listens) cannot_listen(path);
  return result;
}

FileDescriptor accept_from(const FileDescriptor& listener) {
  for (;;) {
    FileDescriptor peer(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!peer || is_of_same_user(peer.get())) return peer;
  }
}

ConnectionAttempt attempt_to_connect(const std::string& path) {
  const sockaddr_un address = address_of(path);
  ConnectionAttempt attempt{new_socket(), 0};
  attempt.error = try_to_connect(attempt.socket.get(), address);
  if (attempt.error != 0) attempt.socket.reset();
  return attempt;
}

FileDescriptor connect_to(const std::string& path, Deadline deadline) {
  for (;;) {
    std::optional<ConnectionAttempt> attempt = ask_for_connection(path, deadline);
    if (!attempt) attempt = attempt_to_connect(path);
    if (attempt->error == 0) {
      require_listener_of(::geteuid(), attempt->socket.get(), path);
      return std::move(attempt->socket);
    }
    // The listener's queue is full: there is nothing to poll for.
    const bool busy = attempt->error == EAGAIN || attempt->error == EINTR;
    if (!busy || Clock::now() >= deadline)
      throw std::runtime_error(
          fmt::format("cannot connect to '{}': {}", path,
                      busy ? "its launcher does not accept" : std::strerror(attempt->error)));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace understudy::compositor
