// SPDX-License-Identifier: Apache-2.0
// `understudy view` without `--web`: a volume in a window of this machine, by SDL and without OpenGL.
#pragma once

#include <stop_token>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

struct WindowScript {
  int frames = 0;      ///< then the window closes; 0: when it is closed by hand
  double orbit = 0;    ///< degrees of azimuth from one frame to the next
  bool plays = false;  ///< each frame shows the next time step
  std::string save;    ///< the last frame, as PNG
};

/// Until the window is closed, the script is over or `stop` is requested. A service that is lost is made again,
/// and the window's title says so meanwhile. Throws std::runtime_error where there can be no window, and what
/// keeps the volume from being loaded the first time.
void show_in_window(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                    const std::stop_token& stop, const WindowScript& script);

}  // namespace understudy::launcher
