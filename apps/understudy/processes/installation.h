// SPDX-License-Identifier: Apache-2.0
// Locations of the parts of Understudy, relative to this program: in the build folder, or installed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace understudy::launcher {

struct Installation {
  std::filesystem::path programs;   ///< …/bin
  std::filesystem::path libraries;  ///< build/lib, or …/lib/understudy
  std::filesystem::path data;       ///< …/share/understudy

  std::filesystem::path node() const { return programs / "understudy-node"; }
  std::filesystem::path shim() const { return libraries / "libunderstudy.so"; }
  std::filesystem::path auditor() const { return libraries / "libunderstudy-audit.so"; }
  std::filesystem::path entry_folder() const { return libraries / "entry"; }
};

/// Determined from /proc/self/exe, so that both kinds of folders can be moved. Throws
/// std::runtime_error without /proc.
Installation this_installation();

/// Returns the program `name` on PATH; empty if there is none.
std::optional<std::filesystem::path> program_on_path(const std::string& name);

}  // namespace understudy::launcher
