// SPDX-License-Identifier: Apache-2.0
// Signals as messages: while an inbox lives they wait in a file descriptor, to be polled beside sockets, and
// none interrupts the program. Children do not inherit this (see ChildProcess).
#pragma once

#include <signal.h>
#include <sys/signalfd.h>

#include <initializer_list>
#include <optional>

namespace understudy::launcher {

struct ReceivedSignal {
  int number = 0;
  bool from_terminal = false;  ///< Ctrl-C and the like: the whole foreground group has got it already
};

class SignalInbox {
 public:
  /// Throws std::system_error.
  explicit SignalInbox(std::initializer_list<int> numbers);
  SignalInbox(const SignalInbox&) = delete;
  SignalInbox& operator=(const SignalInbox&) = delete;
  ~SignalInbox();

  int descriptor() const { return descriptor_; }
  /// The next signal that waits; empty when none does.
  std::optional<ReceivedSignal> next();

 private:
  sigset_t before_{};
  int descriptor_ = -1;
};

}  // namespace understudy::launcher
