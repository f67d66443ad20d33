// SPDX-License-Identifier: Apache-2.0
// The user's own defaults for `understudy run`, from a TOML file: for all viewers, and for individual ones.
//
//   nodes = 2                        # --nodes 2
//   report = "/tmp/understudy.json"
//   require = true                   # a switch; false: no effect
//   [paraview]                       # for viewers with this name of program or Python script, in any case
//   nodes = 4
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace understudy::launcher {

struct ConfiguredOption {
  std::string name;   ///< name of the option, without "--"
  std::string value;  ///< value as text; "on" or "off" for true or false
  bool is_true_or_false = false;
  std::string section;  ///< section of a viewer; empty: for all viewers
  int line = 0;
};

/// Returns $UNDERSTUDY_CONFIG if it is set, even if empty; otherwise understudy.toml in $XDG_CONFIG_HOME or
/// ~/.config. Empty: there is no file to read.
std::filesystem::path configuration_file();

/// Returns the options in `file` for a viewer, each once: those in its sections take precedence over those for
/// all viewers. Empty if there is no file. Throws std::runtime_error with the file, the line and what is wrong.
std::vector<ConfiguredOption> configured_options(const std::filesystem::path& file,
                                                 const std::vector<std::string>& viewer);

}  // namespace understudy::launcher
