// SPDX-License-Identifier: Apache-2.0
#include "tests/apps/viewer/virtual_display.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <utility>

extern char** environ;

namespace viewer_test {

std::optional<VirtualDisplay> VirtualDisplay::start(std::string without) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int display_descriptor = 3;
  posix_spawn_file_actions_adddup2(&actions, ends[1], display_descriptor);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  char program[] = "Xvfb", option[] = "-displayfd", descriptor[] = "3", screen[] = "-screen", number[] = "0",
       format[] = "800x600x24", no_reset[] = "-noreset", extension[] = "-extension";
  char* arguments[] = {program, option,   descriptor, screen,         number,
                       format,  no_reset, extension,  without.data(), nullptr};
  if (without.empty()) arguments[7] = nullptr;
  pid_t server = 0;
  const int failed = posix_spawnp(&server, program, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string name;
  // The server writes its display number and a newline when it accepts clients, and closes the pipe if it
  // cannot start.
  for (char c = 0; failed == 0 && read(ends[0], &c, 1) == 1 && c != '\n';) name += c;
  close(ends[0]);
  if (failed != 0) return std::nullopt;
  if (name.empty()) {
    waitpid(server, nullptr, 0);
    return std::nullopt;
  }
  return VirtualDisplay(server, ":" + name);
}

VirtualDisplay::VirtualDisplay(VirtualDisplay&& other) noexcept
    : server_(std::exchange(other.server_, 0)), name_(std::move(other.name_)) {}

VirtualDisplay::~VirtualDisplay() {
  if (server_ == 0) return;
  kill(server_, SIGTERM);
  waitpid(server_, nullptr, 0);
}

}  // namespace viewer_test
