// SPDX-License-Identifier: Apache-2.0
// `--memory` of `render` and `view`: what each rank may take, and how much of that is for bricks.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace understudy::launcher {

/// `memory` becomes bytes, or stays "auto". `what` says for what.
void add_memory_option(CLI::App& subcommand, std::string& memory, const std::string& what);

struct VolumeMemory {
  std::uint64_t bytes = 0;  ///< that each rank may take for its part of a volume
  /// Whether no process may take more, or only all ranks together should not: ranks of one machine may keep
  /// bricks for each other.
  bool of_each_process = false;
};

/// Of `ranks` ranks that show images of so many pixels. Auto: of this machine's memory, or without a limit
/// where ranks are elsewhere. Throws std::invalid_argument where `memory` is less than a rank takes without a
/// volume.
VolumeMemory memory_for_volume(const std::string& memory, int ranks, bool ranks_are_here, std::size_t pixels);

/// VolumeMemory::bytes, once it is known how many ranks there are.
using RankMemory = std::function<std::uint64_t(int ranks)>;

}  // namespace understudy::launcher
