// SPDX-License-Identifier: Apache-2.0
// The files that volumes may be read from. The user who requests a volume need not run the process that reads
// it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace understudy::volume {

class ReadableFiles {
 public:
  /// All files that this process may read.
  ReadableFiles() = default;
  /// Only files beneath `folders`; links that lead out of a folder are not followed. Folders are opened now, so
  /// later changes of names have no effect. Throws FileError if one cannot be opened.
  explicit ReadableFiles(std::span<const std::string> folders);

  /// A descriptor for reading the file. Throws FileError, which does not reveal whether other files exist.
  int open(const std::string& path) const;
  /// The same; -1 if there is no such file. A dangling link is an error.
  int open_if_there(const std::string& path) const;
  /// Whether `path` is a folder that may be read.
  bool is_folder(const std::string& path) const;

 private:
  struct Folders;

  int opened(const std::string& path) const;
  int open_in_folders(const std::string& path) const;

  std::shared_ptr<const Folders> folders_;  ///< null: all files
};

/// Opens the relative `path` for reading, if it lies beneath `folder` and no link leads out. Otherwise returns
/// -1 and sets errno; EXDEV and ELOOP mean that it leads elsewhere.
int open_beneath(int folder, const std::string& path);

/// The same for kernels without openat2 (before 5.6, or forbidden in a container): follows no links.
int open_beneath_by_walking(int folder, const std::string& path);

}  // namespace understudy::volume
