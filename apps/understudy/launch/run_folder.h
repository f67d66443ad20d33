// SPDX-License-Identifier: Apache-2.0
// The private folder of one run: counters of the viewer's processes, the socket of its nodes, their log. Mode
// 0700 in compositor::runtime_folder(), removed with everything in it at the end.
#pragma once

#include <filesystem>

namespace understudy::launcher {

class RunFolder {
 public:
  /// Also removes what launchers that were killed without warning left behind. Throws std::system_error.
  RunFolder();
  /// Takes over a folder that was made for it; removed at the end like one of its own. Throws
  /// std::runtime_error when it is not private, or not empty.
  explicit RunFolder(std::filesystem::path made_for_it);
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  ~RunFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  void lock();

  std::filesystem::path path_;
  int lock_ = -1;  ///< held while the launcher lives: how the next one knows a dead launcher's folder
};

}  // namespace understudy::launcher
