// SPDX-License-Identifier: Apache-2.0
#include "spu/control/control_server.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <utility>

#include "compositor/service/blocked_signals.h"
#include "spu/control/control_message.h"

namespace understudy::spu {
namespace {

using compositor::Clock;
using compositor::Deadline;
using compositor::FileDescriptor;

/// Pause after accept() failed for want of a descriptor or of memory: the listener would be ready all the time.
constexpr std::chrono::seconds pause_of_listener{1};

int milliseconds_until(Deadline deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return int(std::clamp<long long>(left, 0, 1 << 30));
}

}  // namespace

ControlServer::ControlServer(const std::filesystem::path& socket, Answer answer)
    : path_(socket), folder_(socket.parent_path()), answer_(std::move(answer)) {
  wake_ = FileDescriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake_) throw std::runtime_error(fmt::format("cannot make an eventfd: {}", std::strerror(errno)));
  listener_ = compositor::listen_at(path_);
  listener_fd_ = listener_.get();
  std::promise<void> ended;
  end_ = ended.get_future();
  const compositor::BlockedSignals blocked;
  try {
    // Detached: a process that exits does not wait for a long answer.
    std::thread([this, ended = std::move(ended)]() mutable {
      serve();
      ended.set_value();
    }).detach();
  } catch (...) {
    ::unlink(path_.c_str());
    throw;
  }
}

ControlServer::~ControlServer() {
  stop(std::chrono::milliseconds(0));
  end_.wait();
}

void ControlServer::stop(std::chrono::milliseconds patience) noexcept {
  if (stopping_.exchange(true)) return;
  ::unlink(path_.c_str());
  ::rmdir(folder_.c_str());
  const std::uint64_t once = 1;
  if (serves_ && ::write(wake_.get(), &once, sizeof once) == sizeof once) end_.wait_for(patience);
}

void ControlServer::leave_to_parent() noexcept {
  if (const int listener = listener_fd_.exchange(-1); listener >= 0) ::close(listener);
}

void ControlServer::serve() {
  try {
    while (!stopping_) wait();
  } catch (const std::exception&) {
    // The viewer can no longer be controlled, and goes on.
  }
  serves_ = false;
  // Also closes connections that were never accepted.
  listener_fd_ = -1;
  listener_.reset();
  for (auto& connection : connections_) connection.reset();
}

void ControlServer::wait() {
  std::array<pollfd, max_control_connections + 2> waiting{};
  Deadline first = Clock::now() + std::chrono::hours(1);
  const bool accepts = Clock::now() >= accepts_from_;
  if (!accepts) first = accepts_from_;
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    waiting[i].fd = -1;
    if (!connections_[i]) continue;
    const bool answers = !connections_[i]->answer.empty();
    waiting[i] = {connections_[i]->socket.get(), short(answers ? POLLOUT : POLLIN), 0};
    first = std::min(first, connections_[i]->deadline);
  }
  pollfd& wake = waiting[max_control_connections];
  pollfd& listener = waiting[max_control_connections + 1];
  wake = {wake_.get(), POLLIN, 0};
  listener = {accepts ? listener_.get() : -1, POLLIN, 0};
  if (::poll(waiting.data(), waiting.size(), milliseconds_until(first)) < 0 && errno != EINTR)
    throw std::runtime_error(fmt::format("poll failed: {}", std::strerror(errno)));
  if (stopping_) return;
  // A viewer may close all descriptors that it does not know.
  if (((wake.revents | listener.revents) & (POLLNVAL | POLLERR | POLLHUP)) != 0)
    throw std::runtime_error("the viewer has closed the descriptors of its control");
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (connections_[i] && !proceed(*connections_[i], waiting[i].revents)) connections_[i].reset();
  }
  if ((listener.revents & POLLIN) != 0) accept();
}

void ControlServer::accept() {
  FileDescriptor socket = compositor::accept_from(listener_);
  if (!socket) {
    const bool gone_already = errno == EAGAIN || errno == EINTR || errno == ECONNABORTED;
    if (!gone_already) accepts_from_ = Clock::now() + pause_of_listener;
    return;
  }
  // The first free place, or that of the connection with the earliest deadline.
  const auto earlier = [](const auto& a, const auto& b) {
    if (!a || !b) return !a && b;
    return a->deadline < b->deadline;
  };
  auto& place = *std::ranges::min_element(connections_, earlier);
  place.emplace(Connection{.socket = std::move(socket), .deadline = Clock::now() + control_patience});
}

bool ControlServer::proceed(Connection& connection, short events) {
  try {
    if (events != 0 && !(connection.answer.empty() ? receive(connection) : send(connection))) return false;
  } catch (const std::exception&) {
    return false;
  }
  return Clock::now() < connection.deadline;
}

bool ControlServer::receive(Connection& connection) {
  std::array<char, max_control_request_bytes> part;
  const ssize_t got = ::recv(connection.socket.get(), part.data(), part.size(), MSG_DONTWAIT);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got == 0) return false;
  connection.received.append(part.data(), std::size_t(got));
  answer_next_line(connection);
  return true;
}

void ControlServer::answer_next_line(Connection& connection) {
  const std::size_t end = connection.received.find('\n');
  const bool whole = end != std::string::npos;
  if (std::min(end, connection.received.size()) >= max_control_request_bytes)
    throw std::runtime_error("the line of a request is too long");
  if (!whole) return;
  connection.answer = answer_(std::string_view(connection.received).substr(0, end));
  connection.received.erase(0, end + 1);
  connection.sent = 0;
  connection.deadline = Clock::now() + control_patience;
}

bool ControlServer::send(Connection& connection) {
  const std::string_view rest = std::string_view(connection.answer).substr(connection.sent);
  const ssize_t sent = ::send(connection.socket.get(), rest.data(), rest.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) return errno == EAGAIN || errno == EINTR;
  connection.sent += std::size_t(sent);
  if (connection.sent < connection.answer.size()) return true;
  connection.answer.clear();
  connection.deadline = Clock::now() + control_patience;
  answer_next_line(connection);
  return true;
}

}  // namespace understudy::spu
