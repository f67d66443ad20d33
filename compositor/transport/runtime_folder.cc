// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/runtime_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

namespace understudy::compositor {

bool is_private_folder(const std::filesystem::path& folder) {
  struct stat about {};
  return ::stat(folder.c_str(), &about) == 0 && S_ISDIR(about.st_mode) && about.st_uid == ::geteuid() &&
         (about.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

std::optional<std::filesystem::path> private_runtime_folder() {
  const char* own = ::secure_getenv("XDG_RUNTIME_DIR");
  if (own == nullptr || *own != '/' || !is_private_folder(own) || ::access(own, W_OK | X_OK) != 0) return {};
  return own;
}

std::filesystem::path runtime_folder() {
  return private_runtime_folder().value_or("/tmp");
}

}  // namespace understudy::compositor
