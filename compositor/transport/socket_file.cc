// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/socket_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <utility>

namespace understudy::compositor {

SocketFile::SocketFile(std::string path) : path_(std::move(path)) {
  struct stat file {};
  if (::lstat(path_.c_str(), &file) != 0) return;
  device_ = file.st_dev;
  inode_ = file.st_ino;
}

SocketFile::~SocketFile() {
  struct stat file {};
  if (::lstat(path_.c_str(), &file) == 0 && file.st_dev == device_ && file.st_ino == inode_)
    ::unlink(path_.c_str());
}

}  // namespace understudy::compositor
