// SPDX-License-Identifier: Apache-2.0
// What the ranks of a node group send each other about a request.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include "compositor/service/limits.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/transport/message.h"
#include "volume/frame_counts.h"
#include "volume/rect.h"

namespace understudy::compositor {

enum class Step : std::uint32_t { end, forget_client, share_memory, request, texels };

/// What rank 0 broadcasts first. The payload of a request follows as the application sent it. For texels their
/// boxes follow, then to each rank the texels that it shows.
struct Order {
  Step step = Step::end;
  MessageType type{};
  std::uint64_t client = 0;
  std::uint64_t payload_bytes = 0;
  volume::VolumeId volume = 0;
  std::uint64_t boxes = 0;
  bool overlapped = false;  ///< whether an image is composited while it is drawn
};

/// What every rank sends every other about its part in a request.
struct Outcome {
  bool refused = false;
  volume::Rect footprint;
  volume::FrameCounts counts;
  std::uint32_t control_messages = 0;  ///< about opaque tiles, to each rank behind
  std::uint64_t control_message_count = 0, control_bytes = 0;
  int process = 0, descriptor = -1;  ///< where this rank keeps the new volume, if others read it
  RankLoad load;
};

using Reason = std::array<char, limits::max_text_bytes>;  // zero-terminated

/// This rank's outcome, with a reason that others need only from the first rank that refused.
struct OwnOutcome : Outcome {
  Reason reason{};
  std::optional<VolumeKey> filling;  ///< the volume whose texels the order concerns

  void refuse(const char* why) {
    refused = true;
    std::strncpy(reason.data(), why, reason.size() - 1);
  }
};

inline const Outcome* first_refusal(const std::vector<Outcome>& outcomes) {
  const auto found = std::ranges::find_if(outcomes, &Outcome::refused);
  return found == outcomes.end() ? nullptr : &*found;
}

/// Adds up what the ranks did; times are the slowest rank's, except that of the processors.
inline volume::FrameCounts sum(const std::vector<Outcome>& outcomes) {
  volume::FrameCounts total;
  for (const Outcome& outcome : outcomes) {
    const volume::FrameCounts& counts = outcome.counts;
    total.rays += counts.rays;
    total.rays_terminated += counts.rays_terminated;
    total.samples += counts.samples;
    total.samples_taken += counts.samples_taken;
    total.samples_hidden += counts.samples_hidden;
    total.dominated_samples += counts.dominated_samples;
    total.blocks += counts.blocks;
    total.blocks_empty += counts.blocks_empty;
    total.nodes_idle += outcome.footprint.empty();
    total.render_ms = std::max(total.render_ms, counts.render_ms);
    total.division_ms = std::max(total.division_ms, counts.division_ms);
    total.processor_ms += counts.processor_ms;
  }
  return total;
}

}  // namespace understudy::compositor
