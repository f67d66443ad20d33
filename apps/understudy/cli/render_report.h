// SPDX-License-Identifier: Apache-2.0
// What a rendering without a viewer reports: a summary, and a JSON report (docs/report.md).
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

/// Figures of the certified error bounds of an image's pixels.
struct BoundFigures {
  double greatest = 0;
  double median = 0;  ///< over the pixels whose rays hit the volume
  double time_ms = 0;
  double asked = 0;  ///< greatest bound that was asked for; 0: the samples were given instead
};

struct RenderFigures {
  std::string file;
  int time_step = 0;
  std::optional<int> channel;  ///< empty: the volume has only one
  volume::FileDescription description;
  volume::TexelMapping mapping;
  int width = 0;
  int height = 0;
  double step = 0;
  volume::RenderRequest request;      ///< of the last frame
  std::vector<std::string> backends;  ///< backends that the nodes of this rendering reported
  int nodes = 0;                      ///< 0: rendered in this process
  double open_ms = 0;
  double load_ms = 0;
  std::vector<double> frame_ms;
  std::optional<BoundFigures> bound;        ///< of the last frame, if requested
  volume::FrameCounts counts;               ///< of the last frame
  std::vector<compositor::RankLoad> ranks;  ///< after the last frame
  compositor::PassFigures passes;
  spu::BudgetCounters budget{};  ///< if an error or a time was requested
};

std::string summary_text(const RenderFigures& figures);
/// Throws std::runtime_error.
void write_render_report(const std::string& path, const RenderFigures& figures);

}  // namespace understudy::launcher
