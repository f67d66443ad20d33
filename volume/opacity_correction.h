// SPDX-License-Identifier: Apache-2.0
// Opacity correction: the transfer function of the same medium for another distance between samples (Engel,
// Hadwiger, Kniss, Rezk-Salama, Weiskopf: Real-Time Volume Graphics, 2006, section 1.4.3).
#pragma once

#include <cstddef>

#include "volume/classification.h"

namespace understudy::volume {

/// `function` for samples `step` of its own distances apart, step > 0:
///
///     alpha(step) = 1 - (1 - alpha)^step,   colour(step) = colour alpha(step) / alpha
///
/// and colour(step) = colour step where alpha is 0. Opacities above 1 count as 1. Between the entries of
/// `function` opacity is linear for its own distance, and for another one it is not: there are as many more
/// entries as fit into `most_entries`, at equal distances, so that what lies between them is nearly linear. At
/// step 1 the function stays as it is.
TransferFunction opacity_corrected(const TransferFunction& function, double step, std::size_t most_entries);

}  // namespace understudy::volume
