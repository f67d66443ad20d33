#include "compositor/tcp/porter.h"

#include <poll.h>
#include <sys/socket.h>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "compositor/service/limits.h"

namespace understudy::compositor {

namespace {

/// What is still on its way when one direction has ended.
constexpr std::chrono::seconds last_words_patience{2};

}  // namespace

Deadline Porter::rest_due() const {
  return Clock::now() + std::chrono::hours(24);
}

void Porter::send_here(const Message& message, Bytes payload, int attach) {
  // Who is slow to take messages slows down the link; who has gone is noticed by his socket.
  here_.send(message.type, message.sequence, payload, Clock::now() + limits::stage_patience, attach);
}

void Porter::carry_out(Message message) {
  const Bytes payload(message.payload);
  send_link(message, {&payload, 1});
}

void Porter::carry_home(Message message) {
  send_here(message);
}

Message Porter::receive_here() {
  for (;;) {
    if (std::optional<Message> message = here_.receive_some()) return std::move(*message);
    const bool within = here_.unfinished();
    const Deadline until = within ? Clock::now() + limits::stall_patience : rest_due();
    if (wait_until_ready(here_.fd(), POLLIN, until)) continue;
    if (within) throw ConnectionLost("stopped in the midst of a message");
    rest();
  }
}

std::string Porter::run() {
  std::mutex mutex;
  std::condition_variable changed;
  int ended = 0;
  std::string why;
  // One direction: `next` takes from `from` until it cannot.
  const auto direction = [&](int from, int to, const std::function<void()>& next) {
    std::string reason;
    try {
      for (;;) next();
    } catch (const ConnectionLost&) {
      // Its reader is told by what follows.
    } catch (const std::exception& error) {
      reason = error.what();
    }
    // The other side hears the end after all that was said before it.
    ::shutdown(from, SHUT_RD);
    ::shutdown(to, SHUT_WR);
    const std::scoped_lock lock(mutex);
    if (ended++ == 0) why = reason;
    changed.notify_all();
  };
  {
    const std::jthread out([&] { direction(here_.fd(), link_.fd(), [&] { carry_out(receive_here()); }); });
    const std::jthread home([&] { direction(link_.fd(), here_.fd(), [&] { carry_home(link_.receive()); }); });
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return ended > 0; });
    changed.wait_for(lock, last_words_patience, [&] { return ended == 2; });
    ::shutdown(here_.fd(), SHUT_RDWR);
    ::shutdown(link_.fd(), SHUT_RDWR);
    lock.unlock();
  }
  return why;
}

}  // namespace understudy::compositor
