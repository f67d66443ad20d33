// SPDX-License-Identifier: Apache-2.0
// How many samples the ray caster may be expected to take where, before it does: what a block shows under the
// classification, times how densely the request's samples lie there. Opaque things in front are not thought of.
#pragma once

#include "volume/block_costs.h"
#include "volume/brick/brick_store.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// Samples per unit of texture space around `t`, of all pixels; 0 behind the eye and where the request has
/// none. Planes or steps: pixels times samples along their rays, by the determinant of (x, y, i) over t.
double sample_density(const RenderRequest& request, const Vec3& t);

/// Adds to `costs`, of the store's whole lattice, what each block costs whose lowest cell the store owns. A
/// block that shows nothing costs a small part of what it would: rays must pass it. What has a block of
/// segments is taken to show something. `request` must be valid.
void add_expected_samples(const BrickStore& store, const RenderRequest& request, BlockCosts& costs);

}  // namespace understudy::volume
