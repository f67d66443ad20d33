// SPDX-License-Identifier: Apache-2.0
// A freeglut window with mouse and keys.
#pragma once

#include "apps/viewer/options.h"

namespace viewer {

/// Runs the program in a window until options.frames frames are drawn, or the user quits. Throws Error; without
/// a display, the program exits with ExitCode::no_opengl.
void run_window(const Options& options, Volume volume);

}  // namespace viewer
