// SPDX-License-Identifier: Apache-2.0
// Which files volumes may be read from. Who asks for a volume need not be who runs the process that reads it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

class ReadableFiles {
 public:
  /// All that this process may read.
  ReadableFiles() = default;
  /// Those beneath `folders`, and of none of them what a link leads out of it. Folders are opened now, so that
  /// a name that changes its meaning later changes nothing here. Throws FileError for one that cannot be.
  explicit ReadableFiles(std::span<const std::string> folders);

  /// A descriptor to read the file by. Throws FileError; of files elsewhere it does not tell whether they are.
  int open(const std::string& path) const;
  /// The same; -1 where there is no such file. A link to one is an error.
  int open_if_there(const std::string& path) const;
  /// Whether `path` is a folder that may be read.
  bool is_folder(const std::string& path) const;

 private:
  struct Folders;

  int opened(const std::string& path) const;
  int open_in_folders(const std::string& path) const;

  std::shared_ptr<const Folders> folders_;  ///< null: all files
};

/// Opens `path`, a relative one, to be read, if it lies beneath `folder` and no link leads out. -1 and errno
/// where it does not; EXDEV and ELOOP mean that it leads elsewhere.
int open_beneath(int folder, const std::string& path);

/// The same for kernels without openat2 (before 5.6, or forbidden in a container): no link is followed at all.
int open_beneath_by_walking(int folder, const std::string& path);

}  // namespace understudy::volume
