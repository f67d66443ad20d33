// SPDX-License-Identifier: Apache-2.0
// Another user of this machine, for tests that run as root.
#pragma once

#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

namespace attacks {

constexpr uid_t other_user_id = 65534;

inline bool can_be_another_user() {
  return ::geteuid() == 0;
}

/// A process of another user that runs `work`; its exit status is the result of `work`, 0 to 255.
class OtherUser {
 public:
  explicit OtherUser(const std::function<int()>& work) : process_(::fork()) {
    if (process_ == 0) ::_exit(::setgid(other_user_id) == 0 && ::setuid(other_user_id) == 0 ? work() : 255);
  }
  OtherUser(const OtherUser&) = delete;
  OtherUser& operator=(const OtherUser&) = delete;
  ~OtherUser() { finish(); }

  int finish() {
    int status = 0;
    if (process_ > 0 && ::waitpid(process_, &status, 0) == process_)
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    process_ = -1;
    return status_;
  }

 private:
  pid_t process_;
  int status_ = -1;
};

}  // namespace attacks
