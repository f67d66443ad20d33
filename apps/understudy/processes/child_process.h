// SPDX-License-Identifier: Apache-2.0
// One child process: started, signalled, reaped.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

struct Command {
  std::vector<std::string> arguments;  ///< the program first; looked up on PATH
  Environment environment;
  std::filesystem::path output;  ///< file for both outputs, with no input; empty: those of this process
  bool own_group = false;        ///< apart from the terminal's Ctrl-C, and signalled as a group
  std::vector<int> descriptors;  ///< that it has, too, under their numbers
  /// Does what others ask for, who may have taken it over: it has no input, no terminal, and no descriptors but
  /// its outputs and `descriptors`, and is killed when this process dies.
  bool confined = false;
};

/// How a process ended.
struct Ending {
  int status = 0;  ///< as wait() gives it

  /// The exit status as a shell says it: 128 + signal for a killed process.
  int exit_status() const;
  /// "ended with status 1", "was killed by signal 9 (Killed)".
  std::string text() const;
};

class ChildProcess {
 public:
  /// Throws std::system_error naming the program when it cannot be executed. The child gets SIGTERM, or SIGKILL
  /// if it is confined, should this process die without ending it.
  explicit ChildProcess(const Command& command);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// A child that still runs is ended: see end().
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  /// Empty while it runs.
  std::optional<Ending> poll_ending();
  /// The same, after waiting at most that long.
  std::optional<Ending> wait_for_ending(int patience_ms);
  void signal(int number) const;
  /// Sends SIGTERM, waits up to `patience_ms`, then SIGKILL; returns when the child is reaped.
  void end(int patience_ms);

 private:
  pid_t pid_ = -1;
  bool own_group_ = false;
  std::optional<Ending> ending_;
};

}  // namespace understudy::launcher
