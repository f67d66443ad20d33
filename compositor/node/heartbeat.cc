// SPDX-License-Identifier: Apache-2.0
#include "compositor/node/heartbeat.h"

#include <fcntl.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "compositor/service/limits.h"
#include "compositor/service/service_protocols.h"

namespace understudy::compositor {

namespace {

FileDescriptor another(int descriptor) {
  FileDescriptor copy(::fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  if (!copy) throw std::system_error(errno, std::generic_category(), "no descriptor for the launcher");
  return copy;
}

bool has_gone(int application) {
  pollfd look{application, POLLRDHUP, 0};
  return ::poll(&look, 1, 0) > 0;
}

}  // namespace

Heartbeat::Heartbeat(const Connection& launcher)
    : launcher_(another(launcher.fd()), service_protocols),
      thread_([this](const std::stop_token& stop) { beat(stop); }) {}

void Heartbeat::begin(int application) {
  const std::lock_guard lock(mutex_);
  application_ = application;
  gone_since_.reset();
}

void Heartbeat::end() {
  const std::lock_guard lock(mutex_);
  application_ = -1;
}

std::chrono::milliseconds Heartbeat::unwanted_for() {
  if (application_ < 0 || !has_gone(application_)) return {};
  if (!gone_since_) gone_since_ = Clock::now();
  return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - *gone_since_);
}

void Heartbeat::beat(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  for (;;) {
    woken_.wait_for(lock, stop, limits::alive_interval, [] { return false; });
    if (stop.stop_requested()) return;
    const std::chrono::milliseconds unwanted = unwanted_for();
    try {
      launcher_.send(LauncherMessage::alive, 0,
                     encode(Alive{int(std::min<std::int64_t>(unwanted.count(), limits::max_unwanted_ms))}),
                     Connection::now_or_never());
    } catch (const ConnectionLost&) {
      // The rank's main thread detects a lost launcher itself. A launcher that does not read now may do so
      // later, but it never gets the rest of a message that was cut off.
    }
  }
}

}  // namespace understudy::compositor
