// SPDX-License-Identifier: Apache-2.0
// Receives signals as messages: while an inbox exists, they wait in a file descriptor, which is polled beside
// sockets, and do not interrupt the program. Children do not inherit this (see ChildProcess).
#pragma once

#include <signal.h>
#include <sys/signalfd.h>

#include <initializer_list>
#include <optional>

namespace understudy::launcher {

struct ReceivedSignal {
  int number = 0;
  bool from_terminal = false;  ///< for example by Ctrl-C: the whole foreground group has received it already
};

class SignalInbox {
 public:
  /// Throws std::system_error.
  explicit SignalInbox(std::initializer_list<int> numbers);
  SignalInbox(const SignalInbox&) = delete;
  SignalInbox& operator=(const SignalInbox&) = delete;
  ~SignalInbox();

  int descriptor() const { return descriptor_; }
  /// The next pending signal; empty if there is none.
  std::optional<ReceivedSignal> next();

 private:
  sigset_t before_{};
  int descriptor_ = -1;
};

}  // namespace understudy::launcher
