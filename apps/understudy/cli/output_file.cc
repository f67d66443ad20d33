// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace understudy::launcher {

std::string obstacle_to_writing(const std::string& path) {
  // Of a file that is there nothing is taken away, and one that is made for the question goes again.
  const bool there = ::access(path.c_str(), F_OK) == 0;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
  // A pipe that nobody reads yet can be written later.
  if (file < 0)
    return errno == ENXIO ? "" : fmt::format("{} cannot be written: {}", path, std::strerror(errno));
  ::close(file);
  if (!there) ::unlink(path.c_str());
  return {};
}

CLI::Validator can_be_written(const std::string& ending) {
  return CLI::Validator(
      [ending](std::string& path) {
        if (path.empty()) return std::string();
        const bool regular = !std::filesystem::exists(path) || std::filesystem::is_regular_file(path);
        if (!ending.empty() && regular && std::filesystem::path(path).extension() != ending)
          return fmt::format("{} is written as {}; give a name that ends in it", path, ending);
        return obstacle_to_writing(path);
      },
      "");
}

}  // namespace understudy::launcher
