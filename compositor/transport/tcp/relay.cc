// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/tcp/relay.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "compositor/transport/limits.h"

namespace understudy::compositor {

namespace {

/// For what is still on its way when one direction has ended.
constexpr std::chrono::seconds last_words_patience{2};

}  // namespace

Deadline Relay::rest_due() const {
  return Clock::now() + std::chrono::hours(24);
}

void Relay::send_here(const Message& message, Bytes payload, int attach) {
  // A slow reader slows down the connection; one that has gone is detected by its socket.
  here_.send(message.type, message.sequence, {&payload, 1}, limits::server_patience, attach);
}

void Relay::carry_out(Message message) {
  const Bytes payload(message.payload);
  send_tcp(message, {&payload, 1});
}

void Relay::carry_back(Message message) {
  send_here(message);
}

void Relay::wait_for_here() {
  if (Clock::now() >= tcp_.alive_due()) tcp_.send_alive();
  const bool within = here_.unfinished();
  if (here_.stalled(limits::stall_patience)) throw ConnectionLost("stopped in the midst of a message");
  const Deadline due = within ? Clock::now() + limits::stall_patience : rest_due();
  const bool ready = wait_until_ready(here_.fd(), POLLIN, std::min(due, tcp_.alive_due()));
  if (!ready && !within && Clock::now() >= due) rest();
}

void Relay::hand_on(const MessageHeader& header) {
  std::uint64_t left = header.payload_bytes;
  tcp_.begin(header.type, header.sequence, left);
  while (left > 0) {
    block_.resize(std::min<std::uint64_t>(left, limits::max_tcp_block_bytes));
    for (std::size_t have = 0; have < block_.size();) {
      const std::size_t got = here_.receive_payload(std::span(block_).subspan(have));
      have += got;
      // A process here that is stopped, by a debugger or a shell, has not gone.
      if (got == 0 && !wait_until_ready(here_.fd(), POLLIN, tcp_.alive_due())) tcp_.send_alive();
    }
    tcp_.send_payload(block_);
    left -= block_.size();
  }
}

void Relay::carry_next_out() {
  for (;;) {
    if (const MessageHeader* header = here_.receive_header()) {
      if (header->payload_bytes > limits::max_tcp_block_bytes && !needs_whole(header->type))
        return hand_on(MessageHeader(*header));
      if (std::optional<Message> message = here_.receive_some()) return carry_out(std::move(*message));
    }
    wait_for_here();
  }
}

std::string Relay::run() {
  std::mutex mutex;
  std::condition_variable changed;
  int ended = 0;
  std::string why;
  // One direction: calls `next` until it throws.
  const auto direction = [&](int from, int to, const std::function<void()>& next) {
    std::string reason;
    try {
      for (;;) next();
    } catch (const ConnectionAbandoned& error) {
      reason = error.what();
    } catch (const ConnectionLost&) {
      // The shutdown below tells the reader.
    } catch (const std::exception& error) {
      reason = error.what();
    }
    // Locked before the shutdown, which also ends the other direction, without a reason of its own.
    const std::scoped_lock lock(mutex);
    if (ended++ == 0) why = reason;
    // The other side sees the end after all that was sent before it.
    ::shutdown(from, SHUT_RD);
    ::shutdown(to, SHUT_WR);
    changed.notify_all();
  };
  {
    const std::jthread out([&] { direction(here_.fd(), tcp_.fd(), [&] { carry_next_out(); }); });
    const std::jthread gather([&] { direction(tcp_.fd(), here_.fd(), [&] { carry_back(tcp_.receive()); }); });
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return ended > 0; });
    changed.wait_for(lock, last_words_patience, [&] { return ended == 2; });
    ::shutdown(here_.fd(), SHUT_RDWR);
    ::shutdown(tcp_.fd(), SHUT_RDWR);
    lock.unlock();
  }
  return why;
}

}  // namespace understudy::compositor
