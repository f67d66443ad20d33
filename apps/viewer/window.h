// SPDX-License-Identifier: Apache-2.0
// A freeglut window with mouse and keys.
#pragma once

#include "apps/viewer/options.h"

namespace viewer {

/// The whole program in a window: until options.frames frames are drawn, or the user leaves.
/// Throws Error; without a display the program ends with ExitCode::no_opengl.
void run_window(const Options& options, Volume volume);

}  // namespace viewer
