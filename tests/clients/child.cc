// SPDX-License-Identifier: Apache-2.0
#include "tests/clients/child.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace clients {
namespace {

constexpr std::chrono::milliseconds between_looks{50};
constexpr std::chrono::seconds patience_with_an_end{20};

bool comes_true_within(std::chrono::milliseconds limit, const std::function<bool()>& condition) {
  const auto until = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(between_looks);
  }
  return true;
}

std::vector<std::string> environment_of(const Command& command) {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    // Tests choose the injection method and the display of a viewer themselves.
    if (name == "LD_PRELOAD" || name == "LD_AUDIT" || name == "DISPLAY" || name.starts_with("UNDERSTUDY_"))
      continue;
    if (equals != std::string::npos) variables[name] = text.substr(equals + 1);
  }
  variables["LIBGL_ALWAYS_SOFTWARE"] = "1";
  for (const auto& [name, value] : command.environment) variables[name] = value;
  std::vector<std::string> entries;
  for (const auto& [name, value] : variables)
    if (!value.empty()) entries.emplace_back(name).append("=").append(value);
  return entries;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Child::Child(const Command& command, const std::filesystem::path& folder) {
  static std::atomic<int> started = 0;
  const std::string stem = "child-" + std::to_string(++started);
  out_ = folder / (stem + ".out");
  err_ = folder / (stem + ".err");
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::vector<std::string> words = command.words;
  std::vector<std::string> environment = environment_of(command);
  const int failed = posix_spawnp(&pid_, words.front().c_str(), &files, &attributes, pointers_to(words).data(),
                                  pointers_to(environment).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw std::runtime_error("cannot start " + words.front() + ": " + std::strerror(failed));
}

Child::~Child() {
  kill(-pid_, SIGKILL);
  if (!status_) waitpid(pid_, nullptr, 0);
}

void Child::signal(int number) const {
  if (!status_) kill(pid_, number);
}

bool Child::running() {
  int status = 0;
  if (!status_ && waitpid(pid_, &status, WNOHANG) == pid_)
    status_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return !status_;
}

std::string Child::out() const {
  return contents(out_);
}

std::string Child::err() const {
  return contents(err_);
}

Outcome Child::finish(std::chrono::milliseconds limit) {
  const auto ended = [this] { return !running(); };
  if (comes_true_within(limit, ended)) return {*status_, out(), err()};
  signal(SIGTERM);
  comes_true_within(patience_with_an_end, ended);
  return {-1, out(), err() + "(it had to be ended)\n"};
}

bool comes_true(const std::function<bool()>& condition) {
  return comes_true_within(patience, condition);
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace clients
