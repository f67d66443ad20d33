// SPDX-License-Identifier: Apache-2.0
// The file by which others find a socket at which this process listens.
#pragma once

#include <sys/types.h>

#include <string>

namespace understudy::compositor {

/// Removes its file when it is destroyed, unless another file has replaced it.
class SocketFile {
 public:
  /// Owns the file that is at `path` now.
  explicit SocketFile(std::string path);
  SocketFile(const SocketFile&) = delete;
  SocketFile& operator=(const SocketFile&) = delete;
  ~SocketFile();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace understudy::compositor
