// SPDX-License-Identifier: Apache-2.0
#include "volume/file/part_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "volume/file/file_error.h"

namespace understudy::volume {

PartFile::PartFile(const std::string& path, Meanwhile meanwhile) : path_(path) {
  std::error_code none;
  // Replaces the target of a symbolic link, not the link itself.
  if (std::filesystem::is_symlink(path, none)) path_ = std::filesystem::weakly_canonical(path, none);
  if (std::filesystem::exists(path_, none) && !std::filesystem::is_regular_file(path_, none))
    throw FileError(
        fmt::format("{}: cannot be written: it is there and no plain file; give another name", path));
  // Others may have write access to the folder, so the name must not be predictable.
  std::uint64_t random = 0;
  if (getrandom(&random, sizeof random, 0) != ssize_t(sizeof random)) fail();
  beside_ = fmt::format("{}.{:016x}.part", path_, random);
  if (meanwhile == Meanwhile::nameless) open_without_name();
  if (file_) return;
  file_.reset(std::fopen(beside_.c_str(), "wbxe"));
  if (!file_) fail();
  has_name_ = true;
}

/// If the file system supports it: nothing is left behind if this process is killed.
void PartFile::open_without_name() {
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  constexpr mode_t as_umask_says = 0666;
  const int descriptor =
      ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, as_umask_says);
  if (descriptor < 0) return;
  file_.reset(::fdopen(descriptor, "wb"));
  if (!file_) ::close(descriptor);
}

PartFile::~PartFile() {
  file_.reset();
  if (has_name_) std::remove(beside_.c_str());
}

void PartFile::append(std::span<const std::byte> bytes) {
  write(bytes);
  size_ += bytes.size();
}

void PartFile::replace(std::uint64_t at, std::span<const std::byte> bytes) {
  if (fseeko(file_.get(), off_t(at), SEEK_SET) != 0) fail();
  write(bytes);
  if (fseeko(file_.get(), 0, SEEK_END) != 0) fail();
}

void PartFile::finish() {
  if (std::fflush(file_.get()) != 0 || fsync(fileno(file_.get())) != 0) fail();
  if (!has_name_) {
    // linkat() cannot replace a file, so the file gets a temporary name first.
    const std::string self = fmt::format("/proc/self/fd/{}", fileno(file_.get()));
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, beside_.c_str(), AT_SYMLINK_FOLLOW) != 0) fail();
    has_name_ = true;
  }
  if (std::fclose(file_.release()) != 0) fail();
  if (std::rename(beside_.c_str(), path_.c_str()) != 0) fail();
  has_name_ = false;
}

void PartFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
}

void PartFile::fail() const {
  throw FileError(fmt::format(
      "{}: cannot be written: {}; check its name, the folder's permissions and the room on the disk", path_,
      std::strerror(errno)));
}

}  // namespace understudy::volume
