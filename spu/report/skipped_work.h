// SPDX-License-Identifier: Apache-2.0
// What frames left out and what they did beside it, in figures and in words.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "spu/report/counters.h"
#include "volume/frame_counts.h"

namespace understudy::spu {

/// What the viewer's process counted, and what the nodes did.
Amounts amounts_of(const Amounts& in_process, const volume::FrameCounts& counts);

/// What one frame left out: "61 % of 9300000 samples (empty-bricks 52 %, hidden-samples 9 %), the image".
std::string sentence_of(const FrameRecord& frame);

using ReasonCounts = std::map<std::string, std::uint64_t>;

/// A line an optimization: what was left out, what was not, and why; then what is not looked for at all.
/// `done_because` by optimization.
std::vector<std::string> lines_about(const Amounts& in_process, const volume::FrameCounts& counts,
                                     const std::array<ReasonCounts, optimization_count>& done_because);

}  // namespace understudy::spu
