// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/sandbox/system_call_filter.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/prctl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>

#ifndef PR_SET_VMA
#define PR_SET_VMA 0x53564d41
#endif

namespace understudy::launcher {
namespace {

/// Allowed with any arguments. By name, because headers of older kernels lack numbers of newer calls.
constexpr auto always = std::to_array<const char*>({
    // Memory, including executable memory: drivers on the CPU compile shaders.
    "brk",
    "madvise",
    "membarrier",
    "memfd_create",
    "mmap",
    "mmap2",
    "mprotect",
    "mremap",
    "munmap",
    // Existing descriptors, and files without a name.
    "close",
    "close_range",
    "dup",
    "dup2",
    "dup3",
    "epoll_create1",
    "epoll_ctl",
    "epoll_pwait",
    "epoll_wait",
    "eventfd2",
    "fallocate",
    "fstat",
    "fstat64",
    "fsync",
    "ftruncate",
    "ftruncate64",
    "_llseek",
    "lseek",
    "pipe2",
    "poll",
    "ppoll",
    "ppoll_time64",
    "pread64",
    "preadv",
    "preadv2",
    "pselect6",
    "pselect6_time64",
    "pwrite64",
    "pwritev",
    "pwritev2",
    "read",
    "readv",
    "select",
    "write",
    "writev",
    // Existing sockets.
    "getpeername",
    "getsockname",
    "getsockopt",
    "recvfrom",
    "recvmmsg",
    "recvmsg",
    "sendmmsg",
    "sendmsg",
    "sendto",
    "setsockopt",
    "shutdown",
    // Threads, signals and exit.
    "exit",
    "exit_group",
    "futex",
    "futex_time64",
    "futex_waitv",
    "getcpu",
    "getpid",
    "getppid",
    "gettid",
    "restart_syscall",
    "rseq",
    "rt_sigaction",
    "rt_sigpending",
    "rt_sigprocmask",
    "rt_sigreturn",
    "rt_sigsuspend",
    "rt_sigtimedwait",
    "sched_get_priority_max",
    "sched_get_priority_min",
    "sched_getaffinity",
    "sched_getparam",
    "sched_getscheduler",
    "sched_yield",
    "set_robust_list",
    "set_tid_address",
    "sigaltstack",
    // Time and system information.
    "clock_getres",
    "clock_gettime",
    "clock_gettime64",
    "clock_nanosleep",
    "clock_nanosleep_time64",
    "getegid",
    "geteuid",
    "getgid",
    "getrandom",
    "getrlimit",
    "getrusage",
    "gettimeofday",
    "getuid",
    "nanosleep",
    "sysinfo",
    "time",
    "times",
    "ugetrlimit",
    "uname",
});

/// Calls on files by name, except those that open existing files.
constexpr auto of_files = std::to_array<const char*>(
    {"access", "creat", "faccessat", "faccessat2", "fchmod", "fstatat64", "getdents64", "lstat", "newfstatat",
     "readlink", "readlinkat", "rename", "renameat", "renameat2", "stat", "statx", "unlink", "unlinkat"});

/// Needed by drivers of graphics cards.
constexpr auto of_cards =
    std::to_array<const char*>({"kcmp", "mlock", "munlock", "timerfd_create", "timerfd_settime"});

/// The second byte of these drivers' ioctls: DRM, NVIDIA's modules for cards and for their outputs,
/// shared device buffers, fences, and AMD's compute module. A terminal's is 'T', which would allow
/// typing into the terminal.
constexpr auto types_of_card_ioctls = std::to_array<char>({'d', 'F', 'm', 'b', '>', 'K'});

/// These fail with EACCES, like files without permission, so that libraries continue without them.
constexpr auto opening_calls =
    std::to_array<const char*>({"creat", "open", "openat", "openat2", "open_by_handle_at"});

class Filter {
 public:
  Filter() : context_(seccomp_init(SCMP_ACT_ERRNO(EPERM)), &seccomp_release) {
    if (!context_) trouble_ = "libseccomp cannot create a filter";
  }

  void add(std::uint32_t action, std::span<const char* const> names) {
    for (const char* name : names) add(action, name, {});
  }

  void add(std::uint32_t action, const char* name, std::initializer_list<scmp_arg_cmp> arguments) {
    const int call = seccomp_syscall_resolve_name(name);
    // Negative: this architecture has no such call, or libseccomp does not support it yet.
    if (!context_ || call < 0) return;
    const int result =
        seccomp_rule_add_array(context_.get(), action, call, unsigned(arguments.size()), arguments.begin());
    if (result != 0)
      trouble_ = fmt::format("libseccomp rejects the rule for {}: {}", name, std::strerror(-result));
  }

  void allow(const char* name, std::initializer_list<scmp_arg_cmp> arguments) {
    add(SCMP_ACT_ALLOW, name, arguments);
  }

  std::string load() {
    if (!trouble_.empty()) return trouble_;
    // Applies to all existing threads, such as a driver's. A binary tree of comparisons is faster than a list.
    int result = seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_TSYNC, 1);
    if (result != 0)
      return fmt::format("libseccomp cannot restrict existing threads: {}", std::strerror(-result));
    seccomp_attr_set(context_.get(), SCMP_FLTATR_CTL_OPTIMIZE, 2);
    result = seccomp_load(context_.get());
    return result == 0 ? std::string()
                       : fmt::format("the kernel rejects the seccomp filter: {}", std::strerror(-result));
  }

 private:
  std::unique_ptr<void, decltype(&seccomp_release)> context_;
  std::string trouble_;
};

scmp_arg_cmp is(unsigned argument, std::uint64_t value) {
  return {argument, SCMP_CMP_EQ, value, 0};
}

/// Matches if, of the bits of `mask`, exactly `bits` are set.
scmp_arg_cmp is_in(unsigned argument, std::uint64_t mask, std::uint64_t bits) {
  return {argument, SCMP_CMP_MASKED_EQ, mask, bits};
}

/// Allows calls only with certain arguments, because others would permit too much.
void allow_by_arguments(Filter& filter) {
  // Threads, but no processes. clone3 hides its flags from the filter; glibc uses clone if clone3 is missing.
  filter.allow("clone", {is_in(0, CLONE_THREAD, CLONE_THREAD)});
  filter.add(SCMP_ACT_ERRNO(ENOSYS), "clone3", {});
  for (const int command :
       {F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL, F_SETFL, F_ADD_SEALS, F_GET_SEALS}) {
    filter.allow("fcntl", {is(1, std::uint64_t(command))});
    filter.allow("fcntl64", {is(1, std::uint64_t(command))});
  }
  for (const int what : {PR_SET_NAME, PR_GET_NAME, PR_SET_VMA})
    filter.allow("prctl", {is(0, std::uint64_t(what))});
  // Signals to this process only, as sent by abort().
  const auto own = std::uint64_t(::getpid());
  filter.allow("kill", {is(0, own)});
  filter.allow("tgkill", {is(0, own)});
  // Only for the calling thread: other ids may belong to other processes.
  filter.allow("get_robust_list", {is(0, 0)});
  filter.allow("sched_setaffinity", {is(0, 0)});
  // Limits may be read, but not set.
  filter.allow("prlimit64", {is(0, 0), is(2, 0)});
  filter.allow("prlimit64", {is(0, own), is(2, 0)});
}

void allow_for_a_card(Filter& filter) {
  filter.add(SCMP_ACT_ALLOW, of_cards);
  // The kernel uses the lower half of the number, so that half is compared.
  for (const char type : types_of_card_ioctls)
    filter.allow("ioctl", {is_in(1, 0xff00, std::uint64_t(type) << 8)});
  filter.allow("sched_setscheduler", {is(0, 0)});
  filter.allow("setpriority", {is(0, PRIO_PROCESS), is(1, 0)});
}

void allow_opening(Filter& filter, Opening opening) {
  if (opening == Opening::nothing) {
    filter.add(SCMP_ACT_ERRNO(EACCES), opening_calls);
    // glibc uses it for fstat() of a descriptor.
    filter.allow("newfstatat", {is_in(3, AT_EMPTY_PATH, AT_EMPTY_PATH)});
    return;
  }
  filter.add(SCMP_ACT_ALLOW, of_files);
  constexpr std::array<std::pair<const char*, unsigned>, 2> with_flags = {{{"open", 1}, {"openat", 2}}};
  for (const auto& [name, flags] : with_flags) {
    const bool reads = opening == Opening::all;
    filter.add(reads ? SCMP_ACT_ALLOW : SCMP_ACT_ERRNO(EACCES), name, {is_in(flags, O_ACCMODE, O_RDONLY)});
    for (const std::uint64_t how : {O_WRONLY, O_RDWR}) filter.allow(name, {is_in(flags, O_ACCMODE, how)});
  }
}

}  // namespace

std::string restrict_system_calls(const SystemCalls& calls) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
    return fmt::format("the kernel cannot disable new privileges: {}", std::strerror(errno));
  Filter filter;
  filter.add(SCMP_ACT_ALLOW, always);
  allow_by_arguments(filter);
  if (calls.renderer == Renderer::graphics_card) allow_for_a_card(filter);
  allow_opening(filter, calls.opening);
  return filter.load();
}

}  // namespace understudy::launcher
