// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/listener.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "compositor/transport/limits.h"
#include "compositor/transport/tcp/tcp_socket.h"

namespace understudy::compositor {

namespace {

/// Connections accepted in one step: pending clients get their turn in between.
constexpr int accepted_at_once = 64;
constexpr std::chrono::seconds say_every{1};

/// Sends a few hundred bytes at the beginning of a connection; does not wait for clients that do not read them.
bool tell(int socket, std::span<const std::byte> bytes) {
  return ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == ssize_t(bytes.size());
}

}  // namespace

Listener::Listener(const TcpAddress& address, const Credentials& credentials, Admission admission,
                   Accept accept, Say say)
    : Listener(address, credentials, std::move(admission), std::move(accept), std::move(say),
               {limits::hello_patience, limits::max_pending_clients}) {}

Listener::Listener(const TcpAddress& address, const Credentials& credentials, Admission admission,
                   Accept accept, Say say, const ListenerLimits& limits)
    : credentials_(credentials),
      admission_(std::move(admission)),
      accept_(std::move(accept)),
      say_(std::move(say)),
      limits_(limits),
      socket_(listen_at(address)),
      address_{address.host, own_address(socket_.get()).port} {}

void Listener::poll_fds(std::vector<pollfd>& fds) const {
  if (Clock::now() >= accept_again_) fds.push_back({socket_.get(), POLLIN, 0});
  for (const PendingClient& pending : pending_) fds.push_back({pending.socket.get(), POLLIN, 0});
}

Deadline Listener::next_deadline() const {
  Deadline next = Clock::now() + std::chrono::hours(1);
  if (Clock::now() < accept_again_) next = accept_again_;
  for (const PendingClient& pending : pending_) next = std::min(next, pending.until);
  return next;
}

void Listener::forget() {
  pending_.clear();
  socket_.reset();
}

void Listener::step() {
  accept_all();
  for (std::size_t i = 0; i < pending_.size();) {
    if (hear(pending_[i])) {
      ++i;
      continue;
    }
    // The process of an accepted client forgets all pending clients; this one must not be among them.
    PendingClient heard = std::move(pending_[i]);
    pending_.erase(pending_.begin() + std::ptrdiff_t(i));
    if (heard.let_in)
      accept_({std::move(heard.socket), heard.handshake.session_keys()}, heard.handshake.connection_request());
  }
}

void Listener::accept_all() {
  for (int count = 0; count < accepted_at_once && Clock::now() >= accept_again_; ++count) {
    FileDescriptor socket(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) {
      if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED) return;
      say_(fmt::format("cannot accept a connection at {}: {}; trying again in a second", address_.text(),
                       std::strerror(errno)));
      accept_again_ = Clock::now() + std::chrono::seconds(1);
      return;
    }
    set_connection_options(socket.get());
    if (pending_.size() >= limits_.pending_clients) make_room();
    pending_.push_back({std::move(socket), Clock::now() + limits_.patience, ServerHandshake(credentials_), {}});
  }
}

void Listener::make_room() {
  // The oldest has had the longest time; the newest may not have had time to send anything.
  pending_.erase(pending_.begin());
}

void Listener::drop(const PendingClient& pending, const std::string& why) {
  ++unsaid_;
  if (Clock::now() < say_again_) return;
  say_again_ = Clock::now() + say_every;
  const std::string others = unsaid_ > 1 ? fmt::format(" (and {} others)", unsaid_ - 1) : "";
  unsaid_ = 0;
  say_(fmt::format("{} was not let in{}: {}", peer_address(pending.socket.get()).text(), others, why));
}

AdmissionVerdict Listener::verdict_on(const PendingClient& pending) const {
  const ConnectionRequest& request = pending.handshake.connection_request();
  if (request.plain && !is_within_machine(pending.socket.get())) return AdmissionVerdict::not_plain;
  return admission_(request);
}

bool Listener::hear(PendingClient& pending) {
  const int socket = pending.socket.get();
  while (const std::size_t wants = pending.handshake.wants()) {
    const std::size_t have = pending.heard.size();
    pending.heard.resize(wants);
    const ssize_t got = ::recv(socket, pending.heard.data() + have, wants - have, MSG_DONTWAIT);
    pending.heard.resize(have + std::size_t(std::max<ssize_t>(got, 0)));
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
      if (Clock::now() < pending.until) return true;
      drop(pending, "it did not prove in time that it has the secret");
      return false;
    }
    if (got <= 0) {
      // A client that connects and leaves without a word only checked whether somebody listens.
      if (have > 0) drop(pending, "it left before it had proved that it has the secret");
      return false;
    }
    if (pending.heard.size() < wants) continue;
    try {
      const std::vector<std::byte> answer = pending.handshake.answer(pending.heard);
      pending.heard.clear();
      if (!tell(socket, answer)) return false;
    } catch (const HandshakeFailed& error) {
      tell(socket, pending.handshake.last_words());
      drop(pending, error.what());
      return false;
    }
  }
  const AdmissionVerdict verdict = verdict_on(pending);
  if (!tell(socket, pending.handshake.verdict(verdict))) return false;
  if (verdict == AdmissionVerdict::too_many)
    drop(pending, "as many clients as are served are here already");
  else if (verdict == AdmissionVerdict::not_offered)
    drop(pending, "it wants a GL server; give understudy serve --gl-server");
  else if (verdict == AdmissionVerdict::not_plain)
    drop(pending, "it wants no encryption; that takes --plain here too, and both ends on this machine");
  else
    pending.let_in = !pending.handshake.connection_request().only_asks;
  return false;
}

}  // namespace understudy::compositor
