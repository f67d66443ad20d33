// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

namespace understudy::launcher {
namespace {

constexpr int default_patience_ms = 3000;

std::vector<char*> pointers_to(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (std::string& string : strings) pointers.push_back(string.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Makes exec close all descriptors after the standard ones.
void close_others_at_exec() {
  if (close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) == 0) return;
  // close_range() with this flag requires Linux 5.11.
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  for (int descriptor = STDERR_FILENO + 1; rlim_t(descriptor) < limit.rlim_cur; ++descriptor)
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
}

bool take_input_from_nowhere() {
  const int input = open("/dev/null", O_RDONLY);
  return input >= 0 && dup2(input, STDIN_FILENO) >= 0;
}

/// Runs between fork and exec, so it is restricted to async-signal-safe calls. Returns only if
/// something failed, with errno set.
void become(const Command& command, char* const* arguments, char* const* environment, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (command.own_group && !command.confined && setpgid(0, 0) != 0) return;
  if (command.confined && setsid() < 0) return;
  const int signal_of_death = command.confined ? SIGKILL : SIGTERM;
  prctl(PR_SET_PDEATHSIG, signal_of_death);
  if (getppid() != parent) raise(signal_of_death);
  if ((command.confined || !command.output.empty()) && !take_input_from_nowhere()) return;
  if (!command.output.empty()) {
    const int output = open(command.output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    if (output < 0) return;
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
  }
  if (command.confined) close_others_at_exec();
  for (const int descriptor : command.descriptors) {
    if (fcntl(descriptor, F_SETFD, 0) != 0) return;
  }
  execvpe(arguments[0], arguments, environment);
}

}  // namespace

int Ending::exit_status() const {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string Ending::text() const {
  if (!WIFSIGNALED(status)) return fmt::format("ended with status {}", WEXITSTATUS(status));
  return fmt::format("was killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
}

ChildProcess::ChildProcess(const Command& command) : own_group_(command.own_group) {
  std::vector<std::string> argument_strings = command.arguments;
  std::vector<std::string> environment_strings = as_strings(command.environment);
  const std::vector<char*> arguments = pointers_to(argument_strings);
  const std::vector<char*> environment = pointers_to(environment_strings);

  // The pipe closes by itself if exec succeeds; otherwise it transmits errno.
  std::array<int, 2> failure{};
  if (pipe2(failure.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    become(command, arguments.data(), environment.data(), parent);
    const int reason = errno;
    (void)!::write(failure[1], &reason, sizeof reason);
    _exit(127);
  }
  int reason = pid_ < 0 ? errno : 0;
  close(failure[1]);
  if (pid_ > 0) {
    while (read(failure[0], &reason, sizeof reason) < 0 && errno == EINTR) {
    }
  }
  close(failure[0]);
  if (reason == 0) return;
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
  throw std::system_error(reason, std::generic_category(), "cannot start " + command.arguments.front());
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), own_group_(other.own_group_), ending_(other.ending_) {}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) end(default_patience_ms);
}

std::optional<Ending> ChildProcess::poll_ending() {
  int status = 0;
  if (!ending_ && waitpid(pid_, &status, WNOHANG) == pid_) ending_ = Ending{status};
  return ending_;
}

void ChildProcess::signal(int number) const {
  if (!ending_) kill(own_group_ ? -pid_ : pid_, number);
}

std::optional<Ending> ChildProcess::wait_for_ending(int patience_ms) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::milliseconds(patience_ms);
  while (!poll_ending() && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return ending_;
}

void ChildProcess::end(int patience_ms) {
  signal(SIGTERM);
  if (wait_for_ending(patience_ms)) return;
  signal(SIGKILL);
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  ending_ = Ending{status};
}

}  // namespace understudy::launcher
