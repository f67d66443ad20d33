// SPDX-License-Identifier: Apache-2.0
// A process `understudy view --web 0`, started by a test.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

extern char** environ;

namespace understudy::launcher {

class ViewProcess {
 public:
  explicit ViewProcess(const std::vector<std::string>& arguments) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::vector<std::string> words{UNDERSTUDY_PROGRAM, "view", "--web", "0"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const int failed = posix_spawn(&process_, UNDERSTUDY_PROGRAM, &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
    if (failed != 0) throw std::runtime_error("understudy cannot be started");
    std::array<char, 4096> line{};
    while (fgets(line.data(), line.size(), output_) != nullptr) {
      const std::string said = line.data();
      const std::size_t port = said.find("http://127.0.0.1:"), secret = said.find("/#secret=");
      if (port == std::string::npos || secret == std::string::npos) continue;
      port_ = std::stoi(said.substr(port + 17));
      secret_ = said.substr(secret + 9);
      while (!secret_.empty() && secret_.back() == '\n') secret_.pop_back();
      return;
    }
    throw std::runtime_error("understudy view has said no link");
  }
  ViewProcess(const ViewProcess&) = delete;
  ViewProcess& operator=(const ViewProcess&) = delete;
  ~ViewProcess() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    fclose(output_);
  }

  int port() const { return port_; }
  const std::string& secret() const { return secret_; }
  pid_t id() const { return process_; }
  std::size_t descriptors() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry :
         std::filesystem::directory_iterator("/proc/" + std::to_string(process_) + "/fd"))
      ++count;
    return count;
  }

 private:
  pid_t process_ = 0;
  std::FILE* output_ = nullptr;
  int port_ = 0;
  std::string secret_;
};

}  // namespace understudy::launcher
