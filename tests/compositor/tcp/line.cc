// SPDX-License-Identifier: Apache-2.0
#include "tests/compositor/tcp/line.h"

#include <fcntl.h>
#include <sys/socket.h>

#include <array>

#include "compositor/transport/tcp/tcp_socket.h"

namespace understudy::compositor::testing {

namespace {

void wait_at(const FileDescriptor& socket) {
  ::fcntl(socket.get(), F_SETFL, 0);
}

}  // namespace

Line::Line(const TcpAddress& to)
    : to_(to), listening_(listen_at(TcpAddress{"127.0.0.1", 0})), address_(own_address(listening_.get())) {
  wait_at(listening_);
  accepting_ = std::jthread([this] { accept_all(); });
}

Line::~Line() {
  go_on();
  cut();
  accepting_.join();
  cut();  // clients accepted meanwhile
}

void Line::accept_all() {
  for (;;) {
    FileDescriptor viewer(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (!viewer) return;
    FileDescriptor server = connect_to(to_, Clock::now() + std::chrono::seconds(20));
    wait_at(server);
    const int near = viewer.get(), far = server.get();
    // A connection buffers little.
    constexpr int kept_bytes = 1 << 20;
    ::setsockopt(near, SOL_SOCKET, SO_RCVBUF, &kept_bytes, sizeof kept_bytes);
    const std::lock_guard lock(mutex_);
    connections_.push_back(std::move(viewer));
    connections_.push_back(std::move(server));
    carriers_.emplace_back([this, near, far] { carry(near, far, false); });
    carriers_.emplace_back([this, near, far] { carry(far, near, true); });
  }
}

void Line::carry(int from, int to, bool down) {
  std::array<char, 1 << 16> bytes;
  for (;;) {
    const ssize_t read = ::recv(from, bytes.data(), bytes.size(), 0);
    wait_while_still();
    if (const double rate = bytes_per_second_; rate > 0 && read > 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(double(read) / rate));
    for (ssize_t sent = 0; sent < read;) {
      const ssize_t now = ::send(to, &bytes[std::size_t(sent)], std::size_t(read - sent), MSG_NOSIGNAL);
      if (now <= 0) break;
      sent += now;
    }
    if (read <= 0) break;
    (down ? bytes_down_ : bytes_up_) += std::uint64_t(read);
  }
  ::shutdown(to, SHUT_RDWR);
  ::shutdown(from, SHUT_RDWR);
}

void Line::wait_while_still() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !still_; });
}

void Line::stand_still() {
  const std::lock_guard lock(mutex_);
  still_ = true;
}

void Line::go_on() {
  const std::lock_guard lock(mutex_);
  still_ = false;
  changed_.notify_all();
}

void Line::cut() {
  ::shutdown(listening_.get(), SHUT_RDWR);
  const std::lock_guard lock(mutex_);
  for (const FileDescriptor& connection : connections_) ::shutdown(connection.get(), SHUT_RDWR);
}

}  // namespace understudy::compositor::testing
