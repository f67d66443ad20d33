// SPDX-License-Identifier: Apache-2.0
#include "volume/file/readable_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/openat2.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "volume/file/file_error.h"

namespace understudy::volume {

namespace {

namespace fs = std::filesystem;

// Without O_NONBLOCK, opening a pipe would wait for its other end.
constexpr int to_read = O_RDONLY | O_CLOEXEC | O_NONBLOCK;

class Folder {
 public:
  explicit Folder(const std::string& name)
      : given_(fs::absolute(name).lexically_normal() / ""),
        number_(::open(name.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)) {
    if (number_ < 0)
      throw FileError(fmt::format("{}: is no folder that can be opened: {}; clients would load volumes from it",
                                  name, std::strerror(errno)));
    real_ = fs::canonical(name) / "";
  }
  Folder(Folder&& other) noexcept
      : given_(std::move(other.given_)),
        real_(std::move(other.real_)),
        number_(std::exchange(other.number_, -1)) {}
  Folder& operator=(Folder&&) = delete;
  ~Folder() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  /// `path` relative to this folder; empty if it lies elsewhere.
  std::optional<std::string> rest_of(const std::string& path) const {
    for (const std::string& name : {given_, real_}) {
      if (path.starts_with(name) && path.size() > name.size()) return path.substr(name.size());
      if (path == name || path + '/' == name) return ".";
    }
    return {};
  }

 private:
  std::string given_;  ///< both end with a slash
  std::string real_;
  int number_;
};

}  // namespace

struct ReadableFiles::Folders {
  std::vector<Folder> all;
};

ReadableFiles::ReadableFiles(std::span<const std::string> folders) {
  auto opened = std::make_shared<Folders>();
  for (const std::string& name : folders) opened->all.emplace_back(name);
  folders_ = std::move(opened);
}

namespace {

[[noreturn]] void fail_to_open(const std::string& path) {
  throw FileError(
      fmt::format("{}: cannot be read: {}; check the path and its permissions", path, std::strerror(errno)));
}

}  // namespace

/// Returns -1 and sets errno if the file cannot be opened.
int ReadableFiles::opened(const std::string& path) const {
  errno = 0;
  return folders_ ? open_in_folders(path) : ::open(path.c_str(), to_read);
}

int ReadableFiles::open(const std::string& path) const {
  const int file = opened(path);
  if (file < 0) fail_to_open(path);
  return file;
}

int ReadableFiles::open_if_there(const std::string& path) const {
  const int file = opened(path);
  if (file >= 0) return file;
  if (errno != ENOENT) fail_to_open(path);
  struct stat about {};
  if (::lstat(path.c_str(), &about) == 0 && S_ISLNK(about.st_mode))
    throw FileError(fmt::format("{}: is a link to a file that is not there; get the file", path));
  return file;
}

bool ReadableFiles::is_folder(const std::string& path) const {
  if (folders_ && folders_->all.empty()) return false;
  try {
    const int file = opened(path);
    if (file < 0) return false;
    struct stat about {};
    const bool is_folder = ::fstat(file, &about) == 0 && S_ISDIR(about.st_mode);
    ::close(file);
    return is_folder;
  } catch (const FileError&) {
    return false;  // reading it will report the reason
  }
}

int ReadableFiles::open_in_folders(const std::string& path) const {
  if (folders_->all.empty())
    throw FileError(
        fmt::format("{}: these nodes load no files for their clients; start them with: understudy serve --data "
                    "FOLDER",
                    path));
  const std::string plain = fs::path(path).lexically_normal();
  for (const Folder& folder : folders_->all) {
    const std::optional<std::string> rest = folder.rest_of(plain);
    if (!rest) continue;
    const int file = open_beneath(folder.number(), *rest);
    if (file >= 0 || (errno != EXDEV && errno != ELOOP)) return file;
  }
  throw FileError(fmt::format(
      "{}: lies in none of the folders that clients may load from (understudy serve --data FOLDER)", path));
}

int open_beneath(int folder, const std::string& path) {
  open_how how{};
  how.flags = to_read;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS;
  constexpr int attempts = 16;  // EAGAIN: a concurrent rename
  for (int i = 0; i < attempts; ++i) {
    const long file = ::syscall(SYS_openat2, folder, path.c_str(), &how, sizeof how);
    if (file >= 0) return int(file);
    if (errno == ENOSYS || errno == EPERM) return open_beneath_by_walking(folder, path);
    if (errno != EAGAIN) break;
  }
  return -1;
}

int open_beneath_by_walking(int folder, const std::string& path) {
  int here = ::fcntl(folder, F_DUPFD_CLOEXEC, 0);
  const fs::path way(path);
  for (auto part = way.begin(); part != way.end() && here >= 0; ++part) {
    if (part->empty()) continue;  // after a trailing slash
    const bool last =
        std::all_of(std::next(part), way.end(), [](const fs::path& after) { return after.empty(); });
    // With these flags, a symbolic link in place of a folder fails with ENOTDIR.
    const int flags = last ? to_read | O_NOFOLLOW : O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    const bool leaves = *part == ".." || part->is_absolute();
    const int next = leaves ? -1 : ::openat(here, part->c_str(), flags);
    const int reason = leaves ? EXDEV : errno;
    ::close(here);
    errno = reason;
    here = next;
  }
  return here;
}

}  // namespace understudy::volume
