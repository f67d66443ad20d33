// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/output_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "apps/understudy/processes/output_obstacle.h"

namespace understudy::launcher {

CLI::Validator can_be_written(const std::string& ending) {
  return CLI::Validator(
      [ending](std::string& path) {
        if (path.empty()) return std::string();
        const bool regular = !std::filesystem::exists(path) || std::filesystem::is_regular_file(path);
        if (!ending.empty() && regular && std::filesystem::path(path).extension() != ending)
          return fmt::format("{}: the file is written as {}; give a name with this ending", path, ending);
        return obstacle_to_writing(path);
      },
      "");
}

}  // namespace understudy::launcher
