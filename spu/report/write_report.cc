// SPDX-License-Identifier: Apache-2.0
// Writes reports to files.
#include <fmt/format.h>
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

/// Devices and pipes are written to, and not replaced by a file.
bool is_replaceable(const std::filesystem::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode) || S_ISLNK(status.st_mode);
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
  if (!is_replaceable(path)) {
    std::FILE* const there = std::fopen(path.c_str(), "we");
    if (there == nullptr || !write_to(there, text)) fail("write");
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
