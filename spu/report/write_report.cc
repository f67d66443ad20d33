// SPDX-License-Identifier: Apache-2.0
// Writes reports to files.
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "compositor/logging/log.h"
#include "spu/report/report.h"

namespace understudy::spu {

namespace {

/// Returns where the user's link leads, or the path itself. Links of other users, who may have write access to
/// the folder, are not followed.
std::filesystem::path target_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return path;
  if (status.st_uid != 0 && status.st_uid != ::geteuid()) return path;
  std::error_code broken;
  const std::filesystem::path target = std::filesystem::weakly_canonical(path, broken);
  return broken ? path : target;
}

/// Blocks SIGPIPE in its scope, and takes it if it came: a pipe that nobody reads any more ends no process.
class NoBrokenPipe {
 public:
  NoBrokenPipe() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoBrokenPipe() {
    constexpr timespec at_once{};
    if (sigismember(&before_, SIGPIPE) == 0) sigtimedwait(&pipe_, nullptr, &at_once);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoBrokenPipe(const NoBrokenPipe&) = delete;
  NoBrokenPipe& operator=(const NoBrokenPipe&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
};

/// Whether all was written; a reader that does not read is waited for a second.
bool write_to(int descriptor, std::string_view text) {
  constexpr int patience_ms = 1000;
  const NoBrokenPipe whole;
  while (!text.empty()) {
    pollfd ready{descriptor, POLLOUT, 0};
    if (::poll(&ready, 1, patience_ms) <= 0) return false;
    const ssize_t part = ::write(descriptor, text.data(), text.size());
    if (part <= 0) return false;
    text.remove_prefix(std::size_t(part));
  }
  return true;
}

/// Devices and pipes are written to, and not replaced by a file.
bool is_special(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

/// Whether the user, or the system, made the path what it is: links and pipes of others are not opened.
bool is_own(const std::filesystem::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && (status.st_uid == 0 || status.st_uid == ::geteuid());
}

bool write_to_special(const std::filesystem::path& path, const std::string& text) {
  if (!is_own(path)) {
    errno = EACCES;
    return false;
  }
  // Nobody may be reading: that must not stop the application.
  const int there = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (there < 0) return false;
  const bool written = write_to(there, text);
  const int reason = errno;
  ::close(there);
  errno = reason;
  return written;
}

bool write_to(std::FILE* file, const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written;
}

}  // namespace

void replace_file(const std::filesystem::path& named, const std::string& text) {
  const auto fail = [&](const char* what) {
    throw std::runtime_error(
        fmt::format("cannot {} the report {}: {}", what, named.string(), std::strerror(errno)));
  };
  const std::filesystem::path path = target_of(named);
  if (is_special(named)) {
    if (!write_to_special(named, text)) fail("write");
    return;
  }
  // The folder may be writable by others: the name cannot be guessed, and no existing file or link is opened.
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != ssize_t(sizeof random)) fail("name");
  const std::string beside = fmt::format("{}.{:016x}.part", path.string(), random);
  std::FILE* file = std::fopen(beside.c_str(), "wxe");
  if (file == nullptr) fail("write");
  if (!write_to(file, text) || std::rename(beside.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    std::remove(beside.c_str());
    errno = reason;
    fail("finish");
  }
}

bool write_report_now(const std::string& path) noexcept {
  static std::atomic<bool> complained = false;
  try {
    const ProcessCounters* const self = &process_counters();
    replace_file(path, report_json(Processes(&self, 1)));
    return true;
  } catch (const std::exception& error) {
    if (!complained.exchange(true)) logging::write(logging::Level::error, error.what());
    return false;
  }
}

void write_report_when_due(const std::string& path) noexcept {
  using Clock = std::chrono::steady_clock;
  constexpr int share = 50;  // at most 1/50 of the run time is spent on writing
  constexpr std::chrono::milliseconds soonest(500);
  static std::atomic<Clock::rep> due = 0;
  const Clock::time_point start = Clock::now();
  Clock::rep expected = due.load();
  if (start.time_since_epoch().count() < expected) return;
  // One thread writes; the others return.
  if (!due.compare_exchange_strong(expected, (start + std::chrono::hours(1)).time_since_epoch().count()))
    return;
  write_report_now(path);
  const Clock::duration cost = Clock::now() - start;
  due = (Clock::now() + std::max<Clock::duration>(soonest, share * cost)).time_since_epoch().count();
}

}  // namespace understudy::spu
