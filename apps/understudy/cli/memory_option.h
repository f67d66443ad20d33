// SPDX-License-Identifier: Apache-2.0
// `--memory` of `render` and `view`: the memory limit of each rank, and how much of it bricks may take.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

/// Adds the option; `memory` becomes a number of bytes, or stays "auto". `what` is the
/// beginning of the help text.
void add_memory_option(CLI::App& subcommand, std::string& memory, const std::string& what);

/// Returns the memory for the volume on each of `ranks` ranks that render images of `pixels` pixels. With
/// `tries_settings`, an error or time budget tries several settings for each image. Auto: from this
/// machine's memory, or unlimited if ranks run elsewhere. Throws std::invalid_argument if `memory` is less
/// than a rank takes without a volume.
VolumeMemory memory_for_volume(const std::string& memory, int ranks, bool ranks_are_here, std::size_t pixels,
                               bool tries_settings = false);

}  // namespace understudy::launcher
