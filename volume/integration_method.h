// SPDX-License-Identifier: Apache-2.0
// How the interval between two samples of a ray is integrated.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// What the samples of a transfer function represent. Pre-integrated: the interval between two samples is a
/// segment on which the field varies linearly from one to the other. In the underlying medium, a constant field
/// shows the entries of the transfer function over one whole step. Segments cover the whole path of a ray
/// through the region (beginning at most one step before the first sample) and are clipped at clip planes and
/// opaque geometry. The transparency of a shorter segment is a power of that of a whole one.
///
/// Adaptive: a whole step is the longest that is taken. Depending on how sharply the transfer function bends
/// near the value in its middle, a step is divided into 1, 2, 4, 8 or 16 equal parts with one sample in the
/// middle of each. The transparency of a part is the corresponding power of the transfer function's. Steps
/// cover and are clipped like segments.
enum class Method : std::uint8_t { post_classified, pre_integrated, adaptive };

}  // namespace understudy::volume
