// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/installation.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace understudy::launcher {

Installation this_installation() {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return {programs, programs.parent_path() / "lib"};
}

std::optional<std::filesystem::path> program_on_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::filesystem::path program = std::filesystem::path(folder) / name;
    if (access(program.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(program)) return program;
  }
  return {};
}

}  // namespace understudy::launcher
