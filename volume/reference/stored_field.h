// SPDX-License-Identifier: Apache-2.0
// The field of a brick store along one ray, exactly: like field_along_ray(), but only in the cells that one
// rank owns.
#pragma once

#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/reference/field_along_ray.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// The stretches of the straight path between two points of texture space, which is `length` long, in order:
/// those in cells that `store` owns, so that the stretches of all ranks together cover the whole path. Cells
/// with a NaN corner are skipped. The store must be finished, and its volume's filter linear.
std::vector<Stretch> stored_field_along_ray(const BrickStore& store, const Vec3& from, const Vec3& to,
                                            double length);

}  // namespace understudy::volume
