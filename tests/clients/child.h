// SPDX-License-Identifier: Apache-2.0
// One program, run as a user would run it, with a time limit and its outputs kept.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace clients {

/// Long enough to call it a failure on the slowest machine.
constexpr std::chrono::seconds patience{240};

struct Command {
  std::vector<std::string> words;                  ///< the program first; looked up on this process's PATH
  std::map<std::string, std::string> environment;  ///< over this process's; an empty value removes the variable
};

struct Outcome {
  int status = -1;  ///< as a shell says it, 128 + signal for a killed process; -1 when it had to be ended
  std::string out;
  std::string err;
};

class Child {
 public:
  /// Starts it as the leader of a process group, with its outputs going to two files in `folder`. Throws
  /// std::runtime_error.
  Child(const Command& command, const std::filesystem::path& folder);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// What still runs of the group is killed.
  ~Child();

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  bool running();
  /// What it has said up to now.
  std::string out() const;
  std::string err() const;
  /// Waits for its end; past `limit` it is told to end, and then killed.
  Outcome finish(std::chrono::milliseconds limit = patience);

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
  std::filesystem::path out_;
  std::filesystem::path err_;
};

/// Waits until `condition` holds. False when it does not within `patience`.
bool comes_true(const std::function<bool()>& condition);

std::string contents(const std::filesystem::path& file);

}  // namespace clients
