// From a transfer function to a table of the segments between two samples.
#pragma once

#include "volume/classification.h"

namespace understudy::volume {

/// Colour and opacity, premultiplied, of a segment of one step on which the field changes evenly from front to
/// back, in a medium of which an even field shows the entries of `function` over one step (light that is
/// absorbed within the segment included). Edges of 256 entries or more; functions of more than 1024 entries are
/// thinned out to them. Takes time in the square of the edge: all segments over the same number of entries are
/// made of equal pieces, and are composed of running composites from the ends of groups of as many pieces (van
/// Herk 1992).
PairTable pre_integrated(const TransferFunction& function);

}  // namespace understudy::volume
