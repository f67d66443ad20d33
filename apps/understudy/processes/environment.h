// SPDX-License-Identifier: Apache-2.0
// Environments of child processes: the viewer's loads the entry library, the nodes' does not.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/understudy/processes/installation.h"

namespace understudy::launcher {

using Environment = std::map<std::string, std::string>;

Environment current_environment();

/// How OpenGL calls reach the shim. Tested with ten ways of loading OpenGL: the auditor intercepts all of them;
/// the other two methods are those available to a user without this program.
enum class InjectionMethod { audit, preload, folder };

struct InjectionSettings {
  std::string variable;         ///< LD_AUDIT, LD_PRELOAD or LD_LIBRARY_PATH
  std::filesystem::path value;  ///< entry that is prepended to the variable
};

InjectionSettings settings_of(InjectionMethod injection, const Installation& installation);

/// Prepends `entry` to a list whose entries are separated by ':'.
void put_in_front(Environment& environment, const std::string& variable, const std::string& entry);

/// Returns the environment of understudy-node and mpirun: without injection, and without the options that
/// are meant for the viewer.
Environment node_environment(Environment environment, const Installation& installation);

/// Returns the variables in the form of execve: "NAME=value" each.
std::vector<std::string> as_strings(const Environment& environment);

}  // namespace understudy::launcher
