// SPDX-License-Identifier: Apache-2.0
// The environment of a process that executes one client's OpenGL calls.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

/// What `whole` has of a fixed list: Understudy's options, and what chooses libraries and drivers of OpenGL.
/// Mesa keeps no shaders in files.
Environment client_environment(const Environment& whole);

/// Folders, and files, in which `environment` says that libraries and drivers of OpenGL are. Names that do not
/// begin at the root are left out.
std::vector<std::filesystem::path> folders_of_libraries(const Environment& environment);

}  // namespace understudy::launcher
