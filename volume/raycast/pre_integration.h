// SPDX-License-Identifier: Apache-2.0
// From a transfer function to a table of the segments between two samples.
#pragma once

#include "volume/classification.h"

namespace understudy::volume {

/// Colour and opacity, premultiplied, of a segment of one step on which the field changes evenly from front to
/// back, in a medium of which an even field shows the entries of `function` over one step (light that is
/// absorbed within the segment included). Edges of 256 entries or more, and up to 1024 where `function` bends
/// sharply: at a bend, interpolation between segments errs by an eighth of the change of slope per entry, and
/// is kept below 1e-3 while the edge allows. Functions of more than 1024 entries are thinned out to them. Takes
/// time in the square of the edge: all segments over the same number of entries are made of equal pieces, and
/// are composed of running composites from the ends of groups of as many pieces (van Herk 1992).
PreIntegrationTable pre_integrated(const TransferFunction& function);

}  // namespace understudy::volume
