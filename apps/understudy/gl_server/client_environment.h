// SPDX-License-Identifier: Apache-2.0
// The environment of a process that executes one client's OpenGL calls.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

/// Returns the variables of `whole` that are in a fixed list: Understudy's options, and those that select
/// libraries and drivers of OpenGL. Disables Mesa's shader cache in files.
Environment client_environment(const Environment& whole);

/// Returns the folders and files in which `environment` places libraries and drivers of OpenGL.
/// Relative paths are omitted.
std::vector<std::filesystem::path> folders_of_libraries(const Environment& environment);

}  // namespace understudy::launcher
