// SPDX-License-Identifier: Apache-2.0
// `understudy trim TRACE --frames A-B -o OUT`: writes a shorter trace that shows the same frames.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "apps/understudy/cli/play.h"

namespace understudy::launcher {

struct TrimPlan {
  std::filesystem::path trace;
  FrameRange frames;
  std::filesystem::path out;
  PlayedRecord* played = nullptr;  ///< receives every record, if the player is guarded (guarded_player.h)
};

/// Writes the shorter trace, plays it, and compares its frames with the original. Throws std::runtime_error,
/// and removes the file, if a frame would differ.
void trim(const TrimPlan& plan);

void add_trim(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
