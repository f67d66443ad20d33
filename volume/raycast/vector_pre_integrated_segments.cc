// SPDX-License-Identifier: Apache-2.0
// Pre-integrated segments.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "volume/raycast/kernel.h"
#include "volume/raycast/ray_caster.h"
#include "volume/raycast/surface_search.h"
#include "volume/raycast/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "volume/raycast/vector_pre_integrated_segments.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h, which defines the instruction set.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace understudy::volume {
namespace HWY_NAMESPACE {

#if UNDERSTUDY_VECTOR_KERNEL

#include "volume/raycast/vector_segments-inl.h"

void vector_pre_integrated_segments(const Scene& scene, const RayPacket& packet, float* rgba,
                                    KernelCounts& counts) {
  walk_segments<true>(scene, packet, rgba, counts);
}

#else

void vector_pre_integrated_segments(const Scene& scene, const RayPacket& packet, float* rgba,
                                    KernelCounts& counts) {
  generic_segments(scene, packet, rgba, counts);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace understudy::volume
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace understudy::volume {

HWY_EXPORT(vector_pre_integrated_segments);

void vector_pre_integrated_segments(const Scene& scene, const RayPacket& packet, float* rgba,
                                    KernelCounts& counts) {
  HWY_DYNAMIC_DISPATCH(vector_pre_integrated_segments)(scene, packet, rgba, counts);
}

}  // namespace understudy::volume
#endif  // HWY_ONCE
