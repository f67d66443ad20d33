// SPDX-License-Identifier: Apache-2.0
// `--memory` of `render` and `view`: what each rank may take, and how much of that is for bricks.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

/// `memory` becomes bytes, or stays "auto". `what` says for what.
void add_memory_option(CLI::App& subcommand, std::string& memory, const std::string& what);

/// Of `ranks` ranks that show images of so many pixels, for a budget with several settings each. Auto: of this
/// machine's memory, or without a limit where ranks are elsewhere. Throws std::invalid_argument where `memory`
/// is less than a rank takes without a volume.
VolumeMemory memory_for_volume(const std::string& memory, int ranks, bool ranks_are_here, std::size_t pixels,
                               bool tries_settings = false);

}  // namespace understudy::launcher
