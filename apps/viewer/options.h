// SPDX-License-Identifier: Apache-2.0
// The viewer's command line.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "apps/viewer/formats/volume_file.h"
#include "apps/viewer/model/camera.h"
#include "apps/viewer/modes/mode.h"
#include "apps/viewer/operator.h"
#include "apps/viewer/preset_file.h"

namespace viewer {

enum class OffscreenSurface { any, pbuffer, framebuffer };

struct Options {
  std::string volume_path;
  VolumeHints hints;

  ModeKind mode = ModeKind::table;
  TimeStep time_step = TimeStep::whole;
  Operator op = Operator::over;
  int slices = 0;  ///< across the box's diagonal; 0: one per finest voxel edge
  const Preset* preset = nullptr;
  std::shared_ptr<const PresetFile> preset_file;  ///< origin of the preset, if it is not built in
  bool frame_and_axes = true;
  bool opaque_ball = false;
  bool second_volume = false;
  std::array<double, 3> background{0, 0, 0};
  bool write_depth = false;

  Camera camera;
  std::array<int, 2> window_size{512, 512};

  bool offscreen = false;
  OffscreenSurface surface = OffscreenSurface::any;

  int frames = 0;    ///< 0: until the window is closed
  double orbit = 0;  ///< degrees of azimuth added from each frame to the next

  std::string screenshot;         ///< PNG of the last frame; empty: none
  std::string screenshot_folder;  ///< PNG of every frame; empty: none
  std::string description;        ///< JSON of the last frame; empty: none
  bool print_times = false;
};

/// Fills `options`. Returns nullopt to continue, otherwise the exit status (after --help,
/// or after an error message).
std::optional<int> parse_command_line(int argc, const char* const* argv, Options& options);

}  // namespace viewer
