// SPDX-License-Identifier: Apache-2.0
// What a rendering without a viewer says about itself: one line, and a JSON report (docs/report.md).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compositor/passes/pass_renderer.h"
#include "compositor/service/loading_service.h"
#include "spu/report/counters.h"
#include "volume/file/texel_stream.h"
#include "volume/frame_counts.h"
#include "volume/request.h"

namespace understudy::launcher {

/// Of the certified bounds of an image's pixels.
struct BoundFigures {
  double greatest = 0;
  double median = 0;  ///< of the pixels that rays through the volume show
  double time_ms = 0;
};

struct RenderFigures {
  std::string file;
  int time_step = 0;
  std::optional<int> channel;  ///< none: the volume has one
  volume::FileDescription description;
  volume::TexelMapping mapping;
  int width = 0;
  int height = 0;
  double step = 0;
  volume::RenderRequest request;      ///< the last frame's
  std::vector<std::string> backends;  ///< what nodes of this rendering said about who casts their rays
  int nodes = 0;                      ///< 0: in this process
  double open_ms = 0;
  double load_ms = 0;
  std::vector<double> frame_ms;
  std::optional<BoundFigures> bound;        ///< of the last frame, where it was asked for
  volume::FrameCounts counts;               ///< of the last frame
  std::vector<compositor::RankLoad> ranks;  ///< after the last frame
  compositor::PassFigures passes;
  spu::BudgetCounters budget{};  ///< where an error or a time was asked for
};

std::string summary_text(const RenderFigures& figures);
/// Throws std::runtime_error.
void write_render_report(const std::string& path, const RenderFigures& figures);

}  // namespace understudy::launcher
