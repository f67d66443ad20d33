// SPDX-License-Identifier: Apache-2.0
// What a process may do after its sandbox is closed. Each test runs in a separate process, since a closed
// sandbox cannot be opened again.
#include "apps/understudy/sandbox/sandbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "apps/understudy/sandbox/file_restriction.h"
#include "compositor/transport/connector.h"
#include "compositor/transport/socket.h"
#include "compositor/transport/socket_file.h"

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;
using compositor::Clock;
using compositor::FileDescriptor;

/// Runs `attempts` in a separate process and returns its text; empty if everything is as expected.
std::string in_a_process(const std::function<std::string()>& attempts) {
  std::array<int, 2> channel{};
  if (::pipe(channel.data()) != 0) return "no pipe";
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    const std::string text = attempts();
    (void)!::write(channel[1], text.data(), text.size());
    ::_exit(0);
  }
  ::close(channel[1]);
  std::string said;
  std::array<char, 256> part{};
  for (ssize_t got = 0; (got = ::read(channel[0], part.data(), part.size())) > 0;)
    said.append(part.data(), std::size_t(got));
  ::close(channel[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (status != 0) said += fmt::format(" [ended with status {:#x}]", status);
  return said;
}

/// Returns "name: error" unless the call failed with `wanted`.
std::string refused(const char* name, long result, int wanted) {
  const int reason = errno;
  if (result < 0 && reason == wanted) return {};
  return fmt::format("{}: {}; ", name, result < 0 ? std::strerror(reason) : "works");
}

std::string closed(const Sandbox& sandbox, Renderer renderer = Renderer::cpu) {
  return sandbox.close(renderer).obstacle;
}

/// Queried at start: a closed sandbox does not permit the query.
const bool has_landlock = landlock_version() > 0;

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = fs::temp_directory_path() / "understudy-sandbox-XXXXXX";
    path_ = ::mkdtemp(name.data());
  }
  ~ScratchFolder() { fs::remove_all(path_); }
  fs::path operator/(const char* name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void make_file(const fs::path& path) {
  const int made = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
  ASSERT_GE(made, 0);
  ::close(made);
}

TEST(Sandbox, OpensNoFileStartsNoProgramMakesNoSocketAndTracesNobody) {
  EXPECT_EQ(in_a_process([] {
              std::string said = closed(Sandbox({}));
              said += refused("open", ::open("/etc/passwd", O_RDONLY), EACCES);
              said += refused("open to write", ::open("/dev/null", O_WRONLY), EACCES);
              said += refused("socket", ::socket(AF_UNIX, SOCK_STREAM, 0), EPERM);
              said += refused("TCP socket", ::socket(AF_INET, SOCK_STREAM, 0), EPERM);
              said += refused("ptrace", ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr), EPERM);
              said += refused("unlink", ::unlink("/nowhere"), EPERM);
              said += refused("setrlimit", ::syscall(SYS_setrlimit, RLIMIT_CORE, nullptr), EPERM);
              said += refused("process_vm_readv", ::syscall(SYS_process_vm_readv, ::getppid(), 0, 0, 0, 0, 0),
                              EPERM);
              said += refused("kill", ::kill(::getppid(), 0), EPERM);
              said += refused("fork", ::syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0), EPERM);
              std::array<char*, 1> none{};
              said += refused("execve", ::execve("/bin/true", none.data(), none.data()), EPERM);
              return said;
            }),
            "");
}

/// Drivers start threads before the sandbox closes, which Landlock does not restrict: the sandbox must still
/// hold them.
TEST(Sandbox, HoldsThreadsThatWereThereBefore) {
  const ScratchFolder named;
  const ScratchFolder home;
  make_file(home / "secret");
  const auto what_a_thread_may = [&](const SandboxFolders& folders, Renderer renderer) {
    return in_a_process([&] {
      const Sandbox sandbox(folders);
      std::atomic<bool> is_closed = false;
      std::string found;
      std::thread driver([&] {
        is_closed.wait(false);
        found = refused("a user's file", ::open((home / "secret").c_str(), O_RDONLY), EACCES) +
                refused("to write it", ::open((home / "secret").c_str(), O_WRONLY), EACCES) +
                refused("both", ::open((home / "secret").c_str(), O_RDWR), EACCES) +
                refused("socket", ::socket(AF_UNIX, SOCK_STREAM, 0), EPERM);
        if (renderer == Renderer::cpu) found += refused("open", ::open("/etc/passwd", O_RDONLY), EACCES);
      });
      std::string said = closed(sandbox, renderer);
      is_closed = true;
      is_closed.notify_all();
      driver.join();
      return said + found;
    });
  };
  EXPECT_EQ(what_a_thread_may({}, Renderer::cpu), "");
  EXPECT_EQ(what_a_thread_may({.written = {named.path()}, .libraries = {}}, Renderer::cpu), "");
  EXPECT_EQ(what_a_thread_may({}, Renderer::graphics_card), "");
}

/// Compiling shaders and casting rays need threads and executable memory.
TEST(Sandbox, StartsThreadsAndMakesMemoryExecutable) {
  EXPECT_EQ(
      in_a_process([] {
        std::string said = closed(Sandbox({}));
        int sum = 0;
        std::thread([&] { sum = 42; }).join();
        if (sum != 42) said += "no thread; ";
        void* const code = ::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (code == MAP_FAILED || ::mprotect(code, 4096, PROT_READ | PROT_EXEC) != 0)
          said += "no executable memory; ";
        const int image = int(::memfd_create("image", MFD_CLOEXEC | MFD_ALLOW_SEALING));
        if (image < 0 || ::fallocate(image, 0, 0, 4096) != 0 || ::fcntl(image, F_ADD_SEALS, F_SEAL_SHRINK) != 0)
          said += "no image buffer; ";
        return said;
      }),
      "");
}

TEST(Sandbox, WritesFilesOnlyIntoFoldersThatWereNamed) {
  const ScratchFolder named;
  const ScratchFolder other;
  EXPECT_EQ(in_a_process([&] {
              std::string said = closed(Sandbox({.written = {named.path()}, .libraries = {}}));
              said += refused("exec", ::execl("/bin/true", "true", nullptr), EPERM);
              said +=
                  refused("another folder", ::open((other / "a").c_str(), O_WRONLY | O_CREAT, 0600), EACCES);
              said += refused("reading", ::open("/etc/passwd", O_RDONLY), EACCES);
              if (!has_landlock) return said;
              if (::open((named / "a").c_str(), O_WRONLY | O_CREAT, 0600) < 0)
                said += "cannot write where it may; ";
              if (::rename((named / "a").c_str(), (named / "b").c_str()) != 0) said += "cannot rename there; ";
              return said;
            }),
            "");
  EXPECT_EQ(fs::exists(named / "b"), has_landlock);
}

/// The kernel accepts at most 16 nested Landlock rulesets.
TEST(Sandbox, OpensNothingWhereLandlockDoesNotTakeEffect) {
  const ScratchFolder named;
  for (const Renderer renderer : {Renderer::cpu, Renderer::graphics_card}) {
    EXPECT_EQ(in_a_process([&] {
                for (int i = 0; i < 100; ++i)
                  if (!restrict_files({.read = {}, .written = {"/"}, .devices = {}}).empty()) break;
                const SandboxState state =
                    Sandbox({.written = {named.path()}, .libraries = {}}).close(renderer);
                std::string said = state.obstacle;
                if (state.landlock != 0 || state.no_landlock.empty()) said += "says that Landlock holds; ";
                said += refused("write", ::open((named / "a").c_str(), O_WRONLY | O_CREAT, 0600), EACCES);
                said += refused("read", ::open("/etc/passwd", O_RDONLY), EACCES);
                said += refused("unlink", ::unlink((named / "a").c_str()), EPERM);
                return said;
              }),
              "");
  }
}

/// The driver of a graphics card opens devices and library files, which Landlock restricts to known paths.
TEST(Sandbox, ReadsForAGraphicsCardWhatLandlockBounds) {
  const ScratchFolder home;
  make_file(home / "secret");
  EXPECT_EQ(in_a_process([&] {
              std::string said = closed(Sandbox({}), Renderer::graphics_card);
              said += refused("a user's file", ::open((home / "secret").c_str(), O_RDONLY), EACCES);
              said += refused("writing", ::open("/etc/understudy", O_WRONLY | O_CREAT, 0600), EACCES);
              said += refused("another device", ::open("/dev/full", O_RDONLY), EACCES);
              said += refused("socket", ::socket(AF_UNIX, SOCK_STREAM, 0), EPERM);
              said += refused("exec", ::execl("/bin/true", "true", nullptr), EPERM);
              if ((::open("/etc/passwd", O_RDONLY) >= 0) != has_landlock) said += "files; ";
              if ((::open("/dev/null", O_RDWR) >= 0) != has_landlock) said += "devices; ";
              return said;
            }),
            "");
}

/// An ioctl can inject input into a terminal.
TEST(Sandbox, MakesNoIoctlsButThoseOfGraphicsCards) {
  EXPECT_EQ(in_a_process([] {
              const int device = ::open("/dev/null", O_RDWR);
              std::string said = closed(Sandbox({}), Renderer::graphics_card);
              char typed = 'x';
              said += refused("TIOCSTI", ::ioctl(device, TIOCSTI, &typed), EPERM);
              said += refused("TIOCLINUX", ::ioctl(device, TIOCLINUX, &typed), EPERM);
              // The kernel rejects these, not the sandbox.
              said += refused("DRM", ::ioctl(device, _IO('d', 0), 0), ENOTTY);
              said += refused("NVIDIA", ::ioctl(device, _IO('F', 0), 0), ENOTTY);
              return said;
            }),
            "");
}

TEST(Sandbox, ChangesNoOtherProcess) {
  for (const Renderer renderer : {Renderer::cpu, Renderer::graphics_card}) {
    EXPECT_EQ(in_a_process([renderer] {
                cpu_set_t processors;
                ::sched_getaffinity(0, sizeof processors, &processors);
                std::string said = closed(Sandbox({}), renderer);
                const sched_param parameters{};
                const pid_t other = ::getppid();
                said +=
                    refused("processors", ::sched_setaffinity(other, sizeof processors, &processors), EPERM);
                said += refused("policy", ::sched_setscheduler(other, SCHED_OTHER, &parameters), EPERM);
                said += refused("priority", ::setpriority(PRIO_PROCESS, id_t(other), 19), EPERM);
                said += refused("those of a user", ::setpriority(PRIO_USER, 0, 19), EPERM);
                said += refused("locks", ::syscall(SYS_get_robust_list, other, nullptr, nullptr), EPERM);
                if (::sched_setaffinity(0, sizeof processors, &processors) != 0) said += "its own processors; ";
                return said;
              }),
              "");
  }
}

TEST(Sandbox, IsEndedFirstWhereMemoryEnds) {
  EXPECT_EQ(in_a_process([] {
              const Sandbox sandbox({});
              std::string score;
              std::ifstream("/proc/self/oom_score_adj") >> score;
              return score == "1000" ? std::string() : score;
            }),
            "");
}

TEST(Sandbox, LeavesNoCoreAndBoundsDescriptors) {
  EXPECT_EQ(in_a_process([] {
              const Sandbox sandbox({});
              rlimit core{};
              rlimit files{};
              ::getrlimit(RLIMIT_CORE, &core);
              ::getrlimit(RLIMIT_NOFILE, &files);
              return core.rlim_max == 0 && files.rlim_max <= 256 ? std::string() : "resources are not bounded";
            }),
            "");
}

TEST(Sandbox, GetsItsConnectionsFromAnotherProcess) {
  const ScratchFolder folder;
  const std::string path = folder / "nodes.sock";
  const FileDescriptor listener = compositor::listen_at(path);
  const compositor::SocketFile file(path);
  auto [ours, its] = compositor::connector_channel();
  std::thread connector([&ours = ours, &path] {
    const std::vector<std::string> allowed = {path, ""};
    while (compositor::wait_until_ready(ours.get(), POLLIN, Clock::now() + std::chrono::minutes(1)) &&
           compositor::answer_connector(ours, allowed)) {
    }
  });
  const std::string said = in_a_process([&its = its, &folder, &path] {
    compositor::connect_through(std::move(its));
    std::string found = closed(Sandbox({}));
    const auto until = Clock::now() + std::chrono::minutes(1);
    try {
      compositor::connect_to("", until);
      found += "connects to nothing; ";
    } catch (const std::exception& error) {
      if (std::string(error.what()).find(std::strerror(EINVAL)) == std::string::npos) found += error.what();
    }
    try {
      const FileDescriptor connection = compositor::connect_to(path, until);
      if (::write(connection.get(), "hello", 5) != 5) found += "cannot write; ";
    } catch (const std::exception& error) {
      found += error.what();
    }
    try {
      compositor::connect_to(folder / "other.sock", until);
      found += "connects to what was not allowed; ";
    } catch (const std::exception& error) {
      if (std::string(error.what()).find(std::strerror(EACCES)) == std::string::npos) found += error.what();
    }
    return found;
  });
  its.reset();
  connector.join();
  EXPECT_EQ(said, "");
  const FileDescriptor accepted = compositor::accept_from(listener);
  std::array<char, 5> text{};
  ASSERT_TRUE(accepted);
  EXPECT_EQ(::read(accepted.get(), text.data(), text.size()), 5);
  EXPECT_EQ(std::string(text.data(), text.size()), "hello");
}

TEST(Sandbox, KnowsDriversOfTheCpuByName) {
  EXPECT_EQ(renderer_named("llvmpipe (LLVM 15.0.6, 256 bits)"), Renderer::cpu);
  EXPECT_EQ(renderer_named("softpipe"), Renderer::cpu);
  EXPECT_EQ(renderer_named("AMD Radeon RX 6800 (navi21)"), Renderer::graphics_card);
  EXPECT_EQ(renderer_named("NVIDIA H100/PCIe/SSE2"), Renderer::graphics_card);
}

}  // namespace
}  // namespace understudy::launcher
