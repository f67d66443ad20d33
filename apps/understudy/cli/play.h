// SPDX-License-Identifier: Apache-2.0
// Plays a trace in this process; started by `understudy replay` and called by tests.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "apps/understudy/gl_server/guarded_player.h"
#include "apps/understudy/progress/progress.h"
#include "spu/options.h"

namespace understudy::launcher {

/// Frames of a trace, counted from 1; both ends included.
struct FrameRange {
  std::uint64_t first = 1;
  std::uint64_t last = std::numeric_limits<std::uint64_t>::max();

  bool contains(std::uint64_t frame) const { return frame >= first && frame <= last; }
};

/// Parses "3-7", "3-" or "3". Throws std::runtime_error if the text is not a range.
FrameRange parse_frame_range(const std::string& text);

struct PlayPlan {
  std::filesystem::path trace;
  FrameRange frames;                  ///< frames that are saved and counted; playing ends after them
  std::filesystem::path save_frames;  ///< folder for images; empty: none are saved
  PlayedRecord* played = nullptr;     ///< receives every record, if the player is guarded (guarded_player.h)
  ProgressStyle progress = ProgressStyle::silent;
};

struct Played {
  std::uint64_t frames = 0;  ///< within the range
  std::uint64_t reads = 0;   ///< images that the application read back, within the range
  std::uint64_t errors = 0;  ///< records that could not be played
};

/// Plays the trace; logs to stderr what could not be played. Throws std::runtime_error if the file is damaged
/// or no context can be created.
Played play(const PlayPlan& plan, const spu::Options& options);

/// Adds the subcommand `play`, which is not shown in the help.
void add_play(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
