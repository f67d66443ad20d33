// SPDX-License-Identifier: Apache-2.0
// Runs a program with an environment and collects its output: the tests of the injection methods examine whole
// processes.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

namespace understudy::testing {

struct Outcome {
  int status = 0;    ///< exit status; 128 + signal if a signal ended it; 124 after 60 s
  std::string text;  ///< standard output and standard error together

  bool says(const std::string& what) const { return text.find(what) != std::string::npos; }
  std::vector<std::string> lines() const {
    std::vector<std::string> found;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) found.push_back(line);
    return found;
  }
};

/// `environment` holds NAME=VALUE; `command` is the program and its arguments. They are quoted, so that the
/// shell does not interpret them.
inline Outcome run_program(const std::vector<std::string>& environment,
                           const std::vector<std::string>& command) {
  const auto quoted = [](const std::string& text) {
    std::string result = " '";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
  };
  // env starts the program, so that neither the shell nor timeout runs under the entry library.
  std::string line = "exec timeout 60 env -u LD_PRELOAD -u LD_AUDIT -u LD_LIBRARY_PATH";
  for (const std::string& variable : environment) line += quoted(variable);
  for (const std::string& word : command) line += quoted(word);
  line += " 2>&1";

  Outcome outcome;
  std::FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) return {.status = 127, .text = "popen failed"};
  std::array<char, 4096> buffer;
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.text.append(buffer.data(), size);
  }
  const int status = pclose(pipe);
  outcome.status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return outcome;
}

}  // namespace understudy::testing
