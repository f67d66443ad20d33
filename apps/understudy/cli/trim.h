// SPDX-License-Identifier: Apache-2.0
// `understudy trim TRACE --frames A-B -o OUT`: a shorter trace that shows the same frames.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "apps/understudy/cli/play.h"

namespace understudy::launcher {

struct TrimPlan {
  std::filesystem::path trace;
  FrameRange frames;
  std::filesystem::path out;
  PlayedRecord* played = nullptr;  ///< told of every record, where somebody looks after the player
};

/// Writes the shorter trace and plays it against the longer one. Throws std::runtime_error when a frame would
/// differ; the file is removed then.
void trim(const TrimPlan& plan);

void add_trim(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
