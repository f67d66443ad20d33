// SPDX-License-Identifier: Apache-2.0
// Computes a pre-integration table from a transfer function.
#pragma once

#include "volume/classification.h"

namespace understudy::volume {

/// Premultiplied colour and opacity of a segment of one step on which the field varies linearly from front to
/// back, in a medium of which a constant field shows the entries of `function` over one step (including
/// absorption within the segment). The edge is 256 entries or more, up to 1024 where `function` bends sharply:
/// at a bend, the error of interpolating between segments is an eighth of the change of slope per entry, and is
/// kept below 1e-3 as far as the edge permits. Functions of more than 1024 entries are resampled to 1024. Takes
/// time quadratic in the edge: all segments over the same number of entries consist of equal pieces, and are
/// composited from running composites that start at the ends of groups of as many pieces (van Herk 1992).
PreIntegrationTable pre_integrated(const TransferFunction& function);

}  // namespace understudy::volume
