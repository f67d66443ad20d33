// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/output_obstacle.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace understudy::launcher {

std::string obstacle_to_writing(const std::string& path) {
  namespace fs = std::filesystem;
  // The file is not opened: the reader of a pipe would see its end.
  std::error_code unknown;
  const bool there = fs::exists(path, unknown);
  if (there && fs::is_directory(path, unknown)) return fmt::format("{} is a folder", path);
  // For a link to a file that does not exist yet, check the folder of that file.
  const fs::path target = fs::weakly_canonical(path, unknown);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const bool can = there ? ::access(path.c_str(), W_OK) == 0 : ::access(folder.c_str(), W_OK | X_OK) == 0;
  return can ? "" : fmt::format("{} cannot be written: {}", path, std::strerror(errno));
}

std::string obstacle_to_writing_into(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fmt::format("{} cannot be created as a folder: {}", folder, error.message());
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return "";
  return fmt::format("{} cannot be written to: {}", folder, std::strerror(errno));
}

}  // namespace understudy::launcher
