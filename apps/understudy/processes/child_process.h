// SPDX-License-Identifier: Apache-2.0
// Starts, signals and reaps one child process.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

struct Command {
  std::vector<std::string> arguments;  ///< program and its arguments; the program is looked up on PATH
  Environment environment;
  std::filesystem::path output;  ///< file for both outputs, with no input; empty: those of this process
  bool own_group = false;        ///< not affected by the terminal's Ctrl-C, and signalled as a group
  std::vector<int> descriptors;  ///< further descriptors to inherit, with the same numbers
  /// For a process that executes requests of others, who may have taken it over: it has no input, no terminal,
  /// no descriptors except its outputs and `descriptors`, and is killed when this process dies.
  bool confined = false;
};

/// How a process ended.
struct Ending {
  int status = 0;  ///< as returned by wait()

  /// The exit status as reported by a shell: 128 + signal for a killed process.
  int exit_status() const;
  /// For example "ended with status 1" or "was killed by signal 9 (Killed)".
  std::string text() const;
};

class ChildProcess {
 public:
  /// Throws std::system_error that names the program if it cannot be executed. If this process dies without
  /// ending the child, the child gets SIGTERM, or SIGKILL if it is confined.
  explicit ChildProcess(const Command& command);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;
  /// Ends a child that still runs: see end().
  ~ChildProcess();

  pid_t pid() const { return pid_; }
  /// Empty while the child runs.
  std::optional<Ending> poll_ending();
  /// The same, after waiting for at most `patience_ms`.
  std::optional<Ending> wait_for_ending(int patience_ms);
  void signal(int number) const;
  /// Sends SIGTERM, waits for up to `patience_ms`, then sends SIGKILL; returns when the child is reaped.
  void end(int patience_ms);

 private:
  pid_t pid_ = -1;
  bool own_group_ = false;
  std::optional<Ending> ending_;
};

}  // namespace understudy::launcher
