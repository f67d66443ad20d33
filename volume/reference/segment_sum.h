// SPDX-License-Identifier: Apache-2.0
// Reference images of requests with surfaces, light or pre-integration, in double precision and ray by ray:
// surfaces are found by bisection, and segments integrated by quadrature. Slow, simple and independent of the
// ray caster.
#pragma once

#include "volume/description.h"
#include "volume/rect.h"
#include "volume/reference/slice_sum.h"

namespace understudy::volume {

struct RenderRequest;

/// Composites all samples, segments and surfaces of `request`, whose samples lie on steps, over the pixels of
/// `rect` that lie in its window; never terminates early. `field` is the field of `volume`. Throws
/// std::invalid_argument when the matrix is singular or there are no steps.
ReferenceImage segment_sum(const Field& field, const VolumeDescription& volume, const RenderRequest& request,
                           const Rect& rect);

}  // namespace understudy::volume
