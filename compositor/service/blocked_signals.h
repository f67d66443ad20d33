// SPDX-License-Identifier: Apache-2.0
// The application's signals are for its own threads: a thread that ran their handlers would bypass the
// application's signal masks, and could end it by a signal that all of its threads block.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <initializer_list>

namespace understudy::compositor {

/// During its lifetime, the calling thread blocks all signals, and threads that it starts block them for good.
/// Faults are not blocked: the system sends them to the thread that causes them, and if they were blocked, it
/// would end the process without calling the application's handler.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    sigfillset(&all);
    for (const int fault : {SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP}) sigdelset(&all, fault);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

}  // namespace understudy::compositor
