// SPDX-License-Identifier: Apache-2.0
// The user's own defaults of `understudy run`, from a TOML file: for all viewers, and for single ones.
//
//   nodes = 2                        # --nodes 2
//   report = "/tmp/understudy.json"
//   require = true                   # a switch; false: as without it
//   [paraview]                       # for viewers whose program or Python script is named so, in any case
//   nodes = 4
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace understudy::launcher {

struct ConfiguredOption {
  std::string name;   ///< of the option, without "--"
  std::string value;  ///< as text; "on" or "off" for true or false
  bool is_true_or_false = false;
  std::string section;  ///< of a viewer; empty: of all
  int line = 0;
};

/// $UNDERSTUDY_CONFIG where that is set, be it to nothing; or else understudy.toml in $XDG_CONFIG_HOME or
/// ~/.config. Empty: none is to be read.
std::filesystem::path configuration_file();

/// What `file` says for a viewer, each option once: those of its sections come before those of all viewers.
/// None where there is no file. Throws std::runtime_error with the file, the line and what is wrong.
std::vector<ConfiguredOption> configured_options(const std::filesystem::path& file,
                                                 const std::vector<std::string>& viewer);

}  // namespace understudy::launcher
