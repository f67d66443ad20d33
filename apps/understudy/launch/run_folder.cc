// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "compositor/transport/runtime_folder.h"

namespace understudy::launcher {
namespace {

constexpr const char* prefix = "understudy-run-";
/// Marks folders made by a launcher: a user's own folder may have such a name, too.
constexpr const char* mark = ".made-by-understudy";

/// A launcher locks its folder right after creating it; folders younger than this are left alone.
constexpr std::time_t young_seconds = 10;

/// Decides by the lock instead of a process id: containers that share /tmp have separate process ids.
void remove_folders_of_dead_launchers(const std::filesystem::path& parent) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(parent, error)) {
    if (!entry.path().filename().string().starts_with(prefix)) continue;
    const int folder = open(entry.path().c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0) continue;
    struct stat status {
    }, marked{};
    if (fstat(folder, &status) == 0 && status.st_uid == geteuid() &&
        fstatat(folder, mark, &marked, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(marked.st_mode) &&
        status.st_ctime + young_seconds < std::time(nullptr) && flock(folder, LOCK_EX | LOCK_NB) == 0) {
      std::filesystem::remove_all(entry.path(), error);
    }
    close(folder);
  }
}

}  // namespace

RunFolder::RunFolder() {
  const std::filesystem::path parent = compositor::runtime_folder();
  remove_folders_of_dead_launchers(parent);
  std::string name = parent / (std::string(prefix) + "XXXXXX");
  if (mkdtemp(name.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(),
                            "cannot create a folder for this run in " + parent.string());
  }
  path_ = name;
  lock();
  std::ofstream(path_ / mark) << "";
}

RunFolder::RunFolder(std::filesystem::path made_for_it) : path_(std::move(made_for_it)) {
  struct stat about {};
  // The content is removed at the end, so none of it may belong to anybody else.
  if (lstat(path_.c_str(), &about) != 0 || !S_ISDIR(about.st_mode) || about.st_uid != geteuid() ||
      (about.st_mode & 07777) != 0700 || !std::filesystem::is_empty(path_))
    throw std::runtime_error(
        "--folder " + path_.string() +
        ": the folder is removed at the end, so it must be empty, yours, and have mode 0700");
  lock();
}

void RunFolder::lock() {
  lock_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0) flock(lock_, LOCK_EX | LOCK_NB);
}

RunFolder::~RunFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
  if (lock_ >= 0) close(lock_);
}

}  // namespace understudy::launcher
