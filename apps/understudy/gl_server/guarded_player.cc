// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/gl_server/guarded_player.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <new>
#include <system_error>

#include "dispatch/call_shape.h"
#include "spu/stream/event.h"

namespace understudy::launcher {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// A PlayedRecord in memory shared with a child process.
class SharedRecord {
 public:
  SharedRecord() {
    void* const memory =
        ::mmap(nullptr, sizeof(PlayedRecord), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) fail("cannot allocate memory for the player");
    record_ = new (memory) PlayedRecord;
  }
  ~SharedRecord() { ::munmap(record_, sizeof(PlayedRecord)); }
  SharedRecord(const SharedRecord&) = delete;
  SharedRecord& operator=(const SharedRecord&) = delete;

  PlayedRecord& operator*() const { return *record_; }

 private:
  PlayedRecord* record_ = nullptr;
};

std::string name_of(std::uint32_t record_id) {
  if (const auto call = spu::find_stable_id(record_id)) return spu::call_name(*call);
  const char* event = spu::event::name_of(record_id);
  return event != nullptr ? event : "the beginning";
}

/// Returns whether the signal is one by which a driver crashes a process.
bool is_fault(int signal) {
  constexpr std::array<int, 5> faults = {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL};
  return std::find(faults.begin(), faults.end(), signal) != faults.end();
}

int ending_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail("cannot wait for the player");
  }
  return status;
}

}  // namespace

int play_guarded(const std::filesystem::path& trace, const std::function<int(PlayedRecord&)>& play) {
  const SharedRecord record;
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) fail("cannot start a process for the player");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) ::_exit(128 + SIGTERM);
    return play(*record);
  }
  const int status = ending_of(child);
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int signal = WTERMSIG(status);
  if (!is_fault(signal)) return 128 + signal;
  fmt::print(stderr,
             "understudy: {}: the OpenGL driver crashed with signal {} ({}) at {}, record {}; give --frames to "
             "replay only the frames before it\n",
             trace.string(), signal, ::strsignal(signal), name_of((*record).id), (*record).number.load());
  return player_crashed;
}

}  // namespace understudy::launcher
