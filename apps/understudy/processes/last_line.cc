// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/last_line.h"

#include <fstream>

namespace understudy::launcher {

std::string last_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    std::erase_if(line, [](unsigned char c) { return c < ' '; });
    if (!line.empty()) last = line;
  }
  return last;
}

}  // namespace understudy::launcher
