// SPDX-License-Identifier: Apache-2.0
// Opacity correction: the transfer function of the same medium for another distance between samples (Engel,
// Hadwiger, Kniss, Rezk-Salama, Weiskopf: Real-Time Volume Graphics, 2006, section 1.4.3).
#pragma once

#include <cstddef>

#include "volume/classification.h"

namespace understudy::volume {

/// Corrects `function` for samples whose distance is `step` times its own, step > 0:
///
///     alpha(step) = 1 - (1 - alpha)^step,   colour(step) = colour alpha(step) / alpha
///
/// and colour(step) = step colour where alpha is 0. Opacities above 1 count as 1. The corrected opacity is not
/// linear between the entries of `function`, so entries are inserted at equal distances, as many as
/// `most_entries` permits, to make it nearly linear between entries. For step 1, `function` is returned
/// unchanged.
TransferFunction opacity_corrected(const TransferFunction& function, double step, std::size_t most_entries);

}  // namespace understudy::volume
