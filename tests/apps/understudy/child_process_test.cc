// SPDX-License-Identifier: Apache-2.0
// What a confined child inherits from its parent, and when it ends.
#include "apps/understudy/processes/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"

namespace understudy::launcher {
namespace {

using compositor::FileDescriptor;

/// Reads a child's output line by line.
class Lines {
 public:
  Lines() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) std::abort();
    reads_ = FileDescriptor(ends[0]);
    writes_ = FileDescriptor(ends[1]);
  }

  int writes() const { return writes_.get(); }
  void close_own_end() { writes_.reset(); }

  /// Returns "" if no writer is left, or if nothing arrives within a minute.
  std::string next() {
    std::string line;
    for (char letter = 0; compositor::wait_until_ready(reads_.get(), POLLIN, patience()) &&
                          ::read(reads_.get(), &letter, 1) == 1 && letter != '\n';)
      line += letter;
    return line;
  }
  /// Returns false if a writer is still left after a minute.
  bool ended() {
    char letter = 0;
    while (compositor::wait_until_ready(reads_.get(), POLLIN, patience()))
      if (::read(reads_.get(), &letter, 1) <= 0) return true;
    return false;
  }

 private:
  static compositor::Deadline patience() { return compositor::Clock::now() + std::chrono::minutes(1); }

  FileDescriptor reads_;
  FileDescriptor writes_;
};

/// Writes to `lines`.
Command shell(const std::string& script, const Lines& lines) {
  Command command{
      .arguments = {"/bin/sh", "-c", fmt::format("exec >/proc/$$/fd/{}; {}", lines.writes(), script)},
      .environment = current_environment()};
  command.descriptors = {lines.writes()};
  command.confined = true;
  return command;
}

TEST(ConfinedChild, HasNoInputAndNoDescriptorsOfItsParentButThoseNamed) {
  Lines lines;
  const FileDescriptor inherited(::open("/dev/zero", O_RDONLY));  // without FD_CLOEXEC
  ASSERT_TRUE(inherited);
  ChildProcess child(shell(
      fmt::format("readlink /proc/$$/fd/0; readlink /proc/$$/fd/{} || echo none", inherited.get()), lines));
  EXPECT_EQ(lines.next(), "/dev/null");
  EXPECT_EQ(lines.next(), "none");
}

TEST(ConfinedChild, IsInASessionOfItsOwnAndSoHasNoTerminal) {
  Lines lines;
  ChildProcess child(shell("cut -d ' ' -f 6 /proc/$$/stat", lines));
  EXPECT_EQ(lines.next(), std::to_string(child.pid()));
}

TEST(ConfinedChild, EndsWithItsParentWhateverItDoesWithSignals) {
  Lines lines;
  const pid_t parent = ::fork();
  if (parent == 0) {
    ChildProcess child(shell("trap '' TERM; echo $$; exec sleep 1000", lines));
    for (;;) ::pause();
  }
  lines.close_own_end();
  const std::string number = lines.next();
  ASSERT_FALSE(number.empty());
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  const bool ended = lines.ended();
  EXPECT_TRUE(ended);
  if (!ended) ::kill(pid_t(std::stoi(number)), SIGKILL);
}

}  // namespace
}  // namespace understudy::launcher
