// SPDX-License-Identifier: Apache-2.0
// How the way between two samples of a ray counts.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// What a transfer function's samples stand for. Pre-integrated: the way between two samples is a segment, on
/// which the field is taken to change evenly from one to the other; of a segment of one whole step is seen what
/// a medium would show of which an even field shows the transfer function's entries. Segments cover a ray's
/// whole way through the region (at most one step before the first sample) and are cut where clip planes and
/// opaque geometry cut the ray; a shorter segment has a power of the whole one's transparency.
///
/// Adaptive: every whole step is the longest that is taken. It is divided into 1, 2, 4, 8 or 16 equal parts, as
/// the transfer function's bends near the value in its middle ask for, and a sample is taken in the middle of
/// each, which has that power of the transfer function's transparency. Steps cover the ray as segments do, and
/// are cut as they are.
enum class Method : std::uint8_t { post_classified, pre_integrated, adaptive };

}  // namespace understudy::volume
