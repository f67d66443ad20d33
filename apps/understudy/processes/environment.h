// SPDX-License-Identifier: Apache-2.0
// The environments of child processes: the viewer's loads the entry library, the nodes' does not.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {

using Environment = std::map<std::string, std::string>;

Environment current_environment();

/// How OpenGL calls reach the shim. Measured over ten ways of loading OpenGL: the auditor catches all of them,
/// the other two are what a user can do without this program.
enum class InjectionMethod { audit, preload, folder };

struct InjectionSettings {
  std::string variable;         ///< LD_AUDIT, LD_PRELOAD or LD_LIBRARY_PATH
  std::filesystem::path value;  ///< what is put in front of it
};

InjectionSettings settings_of(InjectionMethod injection, const Installation& installation);

/// Puts `entry` in front of a list with `:` between entries.
void put_in_front(Environment& environment, const std::string& variable, const std::string& entry);

/// What `understudy-node` and mpirun run in: no injection, and none of the options that are meant for
/// the viewer.
Environment node_environment(Environment environment, const Installation& installation);

/// As execve wants it: "NAME=value" each.
std::vector<std::string> as_strings(const Environment& environment);

}  // namespace understudy::launcher
