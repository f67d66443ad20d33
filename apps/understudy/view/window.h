// SPDX-License-Identifier: Apache-2.0
// `understudy view` without `--web`: displays a volume in a window on this machine, by SDL and without OpenGL.
#pragma once

#include <stop_token>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

struct WindowScript {
  int frames = 0;      ///< number of frames, after which the window closes; 0: until the user closes it
  double orbit = 0;    ///< degrees of azimuth from one frame to the next
  bool plays = false;  ///< each frame shows the next time step
  std::string save;    ///< PNG file for the last frame
};

/// Runs until the window is closed, the script is over or `stop` is requested. If the service is lost,
/// reconnects, which the window's title shows. Throws std::runtime_error if no window can be opened, and
/// whatever prevents the volume from being loaded the first time.
void show_in_window(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                    const std::stop_token& stop, const WindowScript& script);

}  // namespace understudy::launcher
