// SPDX-License-Identifier: Apache-2.0
#include "tests/hosts/own_namespaces.h"

#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

namespace hosts {
namespace {

/// Network interfaces and named network namespaces.
std::set<std::string> networks_of_the_machine() {
  std::set<std::string> found;
  std::error_code missing;
  for (const char* folder : {"/sys/class/net", "/run/netns"})
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) found.insert(entry.path());
  return found;
}

int status_of(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/// The first process of the namespace: orphans become its children. It ends when `test` does, and all others
/// with it.
[[noreturn]] void reap_until(pid_t test) {
  for (;;) {
    int status = 0;
    const pid_t ended = wait(&status);
    if (ended == test) _exit(WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status));
  }
}

void die_with_parent() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
}

}  // namespace

std::string enter_own_namespaces() {
  if (geteuid() != 0) return "only root can make network namespaces";
  const std::set<std::string> before = networks_of_the_machine();
  if (const pid_t outer = fork(); outer > 0) {
    const int status = status_of(outer);
    const bool same = networks_of_the_machine() == before;
    if (!same) std::fprintf(stderr, "own namespaces: the machine's networks are not what they were\n");
    std::exit(status == 0 && !same ? 1 : status);
  }
  die_with_parent();
  if (unshare(CLONE_NEWNET | CLONE_NEWNS | CLONE_NEWUTS | CLONE_NEWPID) != 0)
    return std::string("no namespaces can be made here: ") + std::strerror(errno);
  if (const pid_t first = fork(); first > 0) _exit(status_of(first));
  die_with_parent();
  if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("proc", "/proc", "proc", 0, nullptr) != 0 || mount("none", "/dev/shm", "tmpfs", 0, nullptr) != 0) {
    std::fprintf(stderr, "own namespaces: %s\n", std::strerror(errno));
    _exit(1);
  }
  if (const pid_t test = fork(); test > 0) reap_until(test);
  die_with_parent();
  return {};
}

}  // namespace hosts
