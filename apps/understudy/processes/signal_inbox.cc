// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/signal_inbox.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace understudy::launcher {

SignalInbox::SignalInbox(std::initializer_list<int> numbers) {
  // A parent may have left SIGCHLD ignored; children would then be reaped automatically,
  // and no signal would arrive.
  signal(SIGCHLD, SIG_DFL);
  sigset_t set;
  sigemptyset(&set);
  for (const int number : numbers) sigaddset(&set, number);
  sigprocmask(SIG_BLOCK, &set, &before_);
  descriptor_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  if (descriptor_ < 0) {
    const int reason = errno;
    sigprocmask(SIG_SETMASK, &before_, nullptr);
    throw std::system_error(reason, std::generic_category(), "signalfd");
  }
}

SignalInbox::~SignalInbox() {
  close(descriptor_);
  sigprocmask(SIG_SETMASK, &before_, nullptr);
}

std::optional<ReceivedSignal> SignalInbox::next() {
  signalfd_siginfo info{};
  if (read(descriptor_, &info, sizeof info) != sizeof info) return {};
  return ReceivedSignal{static_cast<int>(info.ssi_signo), info.ssi_code == SI_KERNEL};
}

}  // namespace understudy::launcher
