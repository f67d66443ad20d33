// SPDX-License-Identifier: Apache-2.0
// The files of the project, read once.
#pragma once

#include <string>
#include <vector>

namespace understudy::testing {

struct SourceFile {
  std::string path;  ///< from the project's root
  std::string text;
};

/// Everything that belongs to the project: hidden folders, build folders and results do not.
const std::vector<SourceFile>& project_files();

}  // namespace understudy::testing
