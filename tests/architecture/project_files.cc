// SPDX-License-Identifier: Apache-2.0
#include "tests/architecture/project_files.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace understudy::testing {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<SourceFile> read_files() {
  const fs::path root = UNDERSTUDY_SOURCE_DIR;
  std::vector<SourceFile> files;
  for (fs::recursive_directory_iterator entry(root), end; entry != end; ++entry) {
    const std::string name = entry->path().filename();
    if (entry->is_directory()) {
      const bool results =
          entry.depth() == 0 && (name.starts_with("build") || name == "out" || name == "shared");
      if (name.starts_with(".") || name == "__pycache__" || results) entry.disable_recursion_pending();
    } else if (entry->is_regular_file() && name != ".git") {  // of a git worktree
      files.push_back({fs::relative(entry->path(), root), contents(entry->path())});
    }
  }
  return files;
}

}  // namespace

const std::vector<SourceFile>& project_files() {
  static const std::vector<SourceFile> all = read_files();
  return all;
}

}  // namespace understudy::testing
