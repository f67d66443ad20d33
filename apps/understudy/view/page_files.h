// SPDX-License-Identifier: Apache-2.0
// The files of page/, embedded in the program.
#pragma once

#include <span>
#include <string_view>

namespace understudy::launcher {

struct PageFile {
  std::string_view path;  ///< "/view.js"; index.html is "/"
  std::string_view type;  ///< "text/javascript"
  std::string_view text;
};

std::span<const PageFile> page_files();

}  // namespace understudy::launcher
