// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/installation.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace understudy::launcher {

Installation this_installation() {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto from_programs = [&](const char* path) { return (programs / path).lexically_normal(); };
  Installation installed{programs, from_programs(UNDERSTUDY_LIBRARIES_FROM_PROGRAMS),
                         from_programs(UNDERSTUDY_DATA_FROM_PROGRAMS)};
  if (std::filesystem::exists(installed.shim())) return installed;
  return {programs, from_programs("../lib"), from_programs("../share/understudy")};
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
