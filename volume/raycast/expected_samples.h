// SPDX-License-Identifier: Apache-2.0
// The number of samples that the ray caster is expected to take in each part of the volume, before it casts
// rays: whether a block is visible, times the density of the request's samples. Occlusion is not considered.
#pragma once

#include "volume/block_costs.h"
#include "volume/brick/brick_store.h"
#include "volume/texture_space.h"

namespace understudy::volume {

struct RenderRequest;

/// Samples per unit of texture space near `t`, over all pixels; 0 behind the eye and where the request has
/// none. For planes or steps: pixels times samples along their rays, from the determinant of (x, y, i) over t.
double sample_density(const RenderRequest& request, const Vec3& t);

/// Adds the cost of each block whose lowest cell the store owns to `costs`, which covers the store's whole
/// lattice. An empty block costs a small fraction of its samples, because rays must pass it. Under a
/// PreIntegrationTable, every block counts as visible. `request` must be valid.
void add_expected_samples(const BrickStore& store, const RenderRequest& request, BlockCosts& costs);

}  // namespace understudy::volume
