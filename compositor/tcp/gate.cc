#include "compositor/tcp/gate.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "compositor/service/limits.h"
#include "compositor/tcp/tcp_socket.h"

namespace understudy::compositor {

namespace {

/// Connections taken in one step: those that are here already get their turn in between.
constexpr int accepted_at_once = 64;
constexpr std::chrono::seconds say_every{1};

/// Some hundred bytes at the beginning of a connection; who does not take these is not waited for.
bool tell(int socket, std::span<const std::byte> bytes) {
  return ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == ssize_t(bytes.size());
}

}  // namespace

Gate::Gate(const TcpAddress& address, const Secret& secret, Judge judge, Welcome welcome, Say say)
    : Gate(address, secret, std::move(judge), std::move(welcome), std::move(say),
           {limits::hello_patience, limits::max_strangers}) {}

Gate::Gate(const TcpAddress& address, const Secret& secret, Judge judge, Welcome welcome, Say say,
           const GateLimits& limits)
    : secret_(secret),
      judge_(std::move(judge)),
      welcome_(std::move(welcome)),
      say_(std::move(say)),
      limits_(limits),
      listener_(listen_at(address)),
      address_{address.host, own_address(listener_.get()).port} {}

void Gate::poll_fds(std::vector<pollfd>& fds) const {
  if (Clock::now() >= accept_again_) fds.push_back({listener_.get(), POLLIN, 0});
  for (const Stranger& stranger : strangers_) fds.push_back({stranger.socket.get(), POLLIN, 0});
}

Deadline Gate::next_deadline() const {
  Deadline next = Clock::now() + std::chrono::hours(1);
  if (Clock::now() < accept_again_) next = accept_again_;
  for (const Stranger& stranger : strangers_) next = std::min(next, stranger.until);
  return next;
}

void Gate::forget() {
  strangers_.clear();
  listener_.reset();
}

void Gate::step() {
  accept_all();
  for (std::size_t i = 0; i < strangers_.size();) {
    if (hear(strangers_[i])) {
      ++i;
      continue;
    }
    // Whoever is welcomed becomes a process, which forgets all strangers that there are then.
    Stranger heard = std::move(strangers_[i]);
    strangers_.erase(strangers_.begin() + std::ptrdiff_t(i));
    if (heard.let_in) welcome_(std::move(heard.socket), heard.handshake.wishes());
  }
}

void Gate::accept_all() {
  for (int count = 0; count < accepted_at_once && Clock::now() >= accept_again_; ++count) {
    FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) {
      if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED) return;
      say_(fmt::format("cannot accept a connection at {}: {}; trying again in a second", address_.text(),
                       std::strerror(errno)));
      accept_again_ = Clock::now() + std::chrono::seconds(1);
      return;
    }
    set_link_options(socket.get());
    if (strangers_.size() >= limits_.strangers) make_room();
    strangers_.push_back({std::move(socket), Clock::now() + limits_.patience, ServerHandshake(secret_), {}});
  }
}

void Gate::make_room() {
  // The oldest, which has had the longest time: whoever has just come may not have had his say yet.
  strangers_.erase(strangers_.begin());
}

void Gate::drop(const Stranger& stranger, const std::string& why) {
  ++unsaid_;
  if (Clock::now() < say_again_) return;
  say_again_ = Clock::now() + say_every;
  const std::string others = unsaid_ > 1 ? fmt::format(" (and {} others)", unsaid_ - 1) : "";
  unsaid_ = 0;
  say_(fmt::format("{} was not let in{}: {}", peer_address(stranger.socket.get()).text(), others, why));
}

bool Gate::hear(Stranger& stranger) {
  const int socket = stranger.socket.get();
  while (const std::size_t wants = stranger.handshake.wants()) {
    const std::size_t have = stranger.heard.size();
    stranger.heard.resize(wants);
    const ssize_t got = ::recv(socket, stranger.heard.data() + have, wants - have, MSG_DONTWAIT);
    stranger.heard.resize(have + std::size_t(std::max<ssize_t>(got, 0)));
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
      if (Clock::now() < stranger.until) return true;
      drop(stranger, "it did not prove in time that it has the secret");
      return false;
    }
    if (got <= 0) {
      // Who connects and leaves without a word only wanted to know whether somebody is here.
      if (have > 0) drop(stranger, "it left before it had proved that it has the secret");
      return false;
    }
    if (stranger.heard.size() < wants) continue;
    try {
      const std::vector<std::byte> answer = stranger.handshake.answer(stranger.heard);
      stranger.heard.clear();
      if (!tell(socket, answer)) return false;
    } catch (const HandshakeFailed& error) {
      tell(socket, stranger.handshake.last_words());
      drop(stranger, error.what());
      return false;
    }
  }
  const LinkWishes wishes = stranger.handshake.wishes();
  const LinkVerdict verdict = judge_(wishes);
  if (!tell(socket, stranger.handshake.verdict(verdict))) return false;
  if (verdict == LinkVerdict::too_many)
    drop(stranger, "as many clients as are served are here already");
  else if (verdict == LinkVerdict::not_offered)
    drop(stranger, "it wants a stage; give understudy serve --stage");
  else
    stranger.let_in = !wishes.only_asks;
  return false;
}

}  // namespace understudy::compositor
