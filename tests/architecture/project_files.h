// SPDX-License-Identifier: Apache-2.0
// The files of the project, read once.
#pragma once

#include <string>
#include <vector>

namespace understudy::testing {

struct SourceFile {
  std::string path;  ///< relative to the project's root
  std::string text;
};

/// All files of the project; hidden folders, build folders and results do not belong to it.
const std::vector<SourceFile>& project_files();

}  // namespace understudy::testing
