#include "compositor/service/socket.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace understudy::compositor {

namespace {

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  constexpr std::size_t longest = sizeof address.sun_path - 2;  // and one that listen_at() appends
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

int try_to_connect(int fd, const sockaddr_un& address) {
  return ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ? 0 : errno;
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
  const sockaddr_un address = address_of(path);
  struct stat existing {};
  if (::lstat(path.c_str(), &existing) == 0) {
    if (!S_ISSOCK(existing.st_mode))
      throw std::runtime_error(fmt::format("'{}' exists and is no socket: name another path", path));
    if (try_to_connect(new_socket().get(), address) != ECONNREFUSED)
      throw std::runtime_error(fmt::format("'{}' is in use by another launcher: name another path", path));
  }
  FileDescriptor result = new_socket();
  // A socket that has a name refuses connections until somebody listens at it, as one does whose listener is
  // gone. So it gets its name then.
  sockaddr_un unfinished = address;
  unfinished.sun_path[path.size()] = '~';
  ::unlink(unfinished.sun_path);
  // On Linux the socket's own mode becomes that of its file, so that there is no moment in which others may
  // connect.
  ::fchmod(result.get(), 0600);
  if (::bind(result.get(), reinterpret_cast<const sockaddr*>(&unfinished), sizeof unfinished) != 0 ||
      ::listen(result.get(), SOMAXCONN) != 0 || ::rename(unfinished.sun_path, path.c_str()) != 0)
    throw std::runtime_error(fmt::format("cannot listen at '{}': {}: name a path in a folder that is yours",
                                         path, std::strerror(errno)));
  return result;
}

FileDescriptor connect_to(const std::string& path, Deadline deadline) {
  const sockaddr_un address = address_of(path);
  FileDescriptor result = new_socket();
  for (;;) {
    const int error = try_to_connect(result.get(), address);
    if (error == 0) return result;
    // The listener's queue is full: there is nothing to poll for.
    const bool busy = error == EAGAIN || error == EINTR;
    if (!busy || Clock::now() >= deadline)
      throw std::runtime_error(fmt::format("cannot connect to '{}': {}", path,
                                           busy ? "its launcher does not accept" : std::strerror(error)));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace understudy::compositor
