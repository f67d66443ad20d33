// SPDX-License-Identifier: Apache-2.0
// mpirun and the real node, as the launcher starts them.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

extern char** environ;

namespace understudy::compositor::testing {

// One mpirun and its ranks.
class MpiGroup {
 public:
  MpiGroup(int ranks, const std::string& path, const std::vector<std::string>& options = {}) {
    std::vector<std::string> words{MPIEXEC,
                                   "-n",
                                   std::to_string(ranks),
                                   "--oversubscribe",
                                   "--bind-to",
                                   "none",
                                   "--mca",
                                   "mpi_yield_when_idle",
                                   "1",
                                   UNDERSTUDY_NODE,
                                   "--control",
                                   path};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // OpenMPI keeps memory until it ends; the sanitizer does not look for that here.
    for (const char* setting :
         {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1", "ASAN_OPTIONS=detect_leaks=0"})
      ::putenv(const_cast<char*>(setting));
    EXPECT_EQ(::posix_spawn(&mpirun_, MPIEXEC, nullptr, nullptr, arguments.data(), environ), 0);
  }
  ~MpiGroup() {
    if (mpirun_ > 0) {
      ::kill(mpirun_, SIGTERM);
      wait();
    }
  }
  MpiGroup(const MpiGroup&) = delete;
  MpiGroup& operator=(const MpiGroup&) = delete;

  int wait() {
    int status = 0;
    ::waitpid(std::exchange(mpirun_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::vector<pid_t> ranks() const {
    std::vector<pid_t> result;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      std::ifstream stat(entry.path() / "stat");
      pid_t pid = 0, parent = 0;
      std::string name, state;
      if (stat >> pid >> name >> state >> parent && parent == mpirun_ && name.starts_with("(understudy"))
        result.push_back(pid);
    }
    return result;
  }

 private:
  pid_t mpirun_ = -1;
};

}  // namespace understudy::compositor::testing
