// SPDX-License-Identifier: Apache-2.0
// The environment of a process that executes one client's OpenGL calls.
#pragma once

#include "apps/understudy/processes/environment.h"

namespace understudy::launcher {

/// What `whole` has of a fixed list: Understudy's options, and what chooses libraries and drivers of OpenGL.
/// Mesa keeps no shaders in files.
Environment client_environment(const Environment& whole);

}  // namespace understudy::launcher
