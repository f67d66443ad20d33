// SPDX-License-Identifier: Apache-2.0
// The work that frames skipped, and the work that was done nevertheless, in figures and in words.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "spu/report/counters.h"
#include "volume/frame_counts.h"

namespace understudy::spu {

/// Combines what the viewer's process counted with what the nodes counted.
Amounts amounts_of(const Amounts& in_process, const volume::FrameCounts& counts);

/// The work that one frame skipped: "61 % of 9300000 samples (empty-bricks 52 %, hidden-samples 9 %), the
/// image".
std::string sentence_of(const FrameRecord& frame);

using ReasonCounts = std::map<std::string, std::uint64_t>;

/// One line per optimization: what was skipped, what was not, and why; then the work that is never skipped.
/// `done_because` is indexed by optimization.
std::vector<std::string> lines_about(const Amounts& in_process, const volume::FrameCounts& counts,
                                     const std::array<ReasonCounts, optimization_count>& done_because);

}  // namespace understudy::spu
