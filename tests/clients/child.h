// SPDX-License-Identifier: Apache-2.0
// Runs one program as a user would, with a time limit, and keeps its output.
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

/// Long enough to be called a failure on the slowest machine.
constexpr std::chrono::seconds patience{240};

struct Command {
  std::vector<std::string> words;                  ///< the program first; found on this process's PATH
  std::map<std::string, std::string> environment;  ///< extends this process's; empty values remove variables
};

struct Outcome {
  int status = -1;  ///< as in a shell: 128 + signal if killed; -1 if it had to be ended
  std::string out;
  std::string err;
};

class Child {
 public:
  /// Starts the program as leader of a process group, with its output redirected to two files in `folder`.
  /// Throws std::runtime_error.
  Child(const Command& command, const std::filesystem::path& folder);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// Kills what is still running of the group.
  ~Child();

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  bool running();
  /// Its output so far.
  std::string out() const;
  std::string err() const;
  /// Waits until it ends; after `limit` it is terminated, and then killed.
  Outcome finish(std::chrono::milliseconds limit = patience);

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
  std::filesystem::path out_;
  std::filesystem::path err_;
};

/// Waits until `condition` holds. Returns false if it does not within `patience`.
bool comes_true(const std::function<bool()>& condition);

std::string contents(const std::filesystem::path& file);

}  // namespace clients
