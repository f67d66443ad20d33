// SPDX-License-Identifier: Apache-2.0
// The private folder of one run: counters of the viewer's processes, the socket of its nodes, and their log.
// Mode 0700 in compositor::runtime_folder(), removed with its content at the end.
#pragma once

#include <filesystem>

namespace understudy::launcher {

class RunFolder {
 public:
  /// Creates the folder. Also removes the folders of launchers that were killed. Throws std::system_error.
  RunFolder();
  /// Takes over an existing folder, which is removed at the end, too. Throws std::runtime_error if it is
  /// not private, or not empty.
  explicit RunFolder(std::filesystem::path made_for_it);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  void lock();

  std::filesystem::path path_;
  int lock_ = -1;  ///< held while the launcher lives; tells other launchers that the folder is in use
};

}  // namespace understudy::launcher
