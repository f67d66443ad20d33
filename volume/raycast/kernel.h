// SPDX-License-Identifier: Apache-2.0
// The interface of the kernels: a packet of rays in, premultiplied pixels out. The generic kernels accept every
// texel type, filter and operator and define the result; the others are faster on some combinations and must
// give the same image.
#pragma once

#include <cstdint>

#include "volume/blending_operator.h"
#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/raycast/fog_table.h"
#include "volume/raycast/occupancy_map.h"
#include "volume/raycast/pre_integration_lookup.h"
#include "volume/raycast/ray_setup.h"
#include "volume/raycast/segment_scene.h"
#include "volume/raycast/step_division.h"
#include "volume/raycast/transfer_table.h"
#include "volume/texture_filter.h"

namespace understudy::volume {

/// All inputs of a kernel except its rays. Exactly one of `table`, `map` and `pairs` is set, except that
/// `table` and `pairs` are both set for pre-integrated `segments`.
struct Scene {
  const BrickStore* store = nullptr;
  const OccupancyMap* skip = nullptr;
  const TransferTable* table = nullptr;
  const float* bounds = nullptr;  ///< per block its upper bound under a maximum (block_bounds()); null: unknown
  const LinearMap* map = nullptr;
  const PreIntegrationLookup* pairs = nullptr;
  /// Surfaces, light and pre-integration, for the segment kernels; null: for the other kernels.
  const SegmentScene* segments = nullptr;
  /// Adaptive steps: what their parts show, and per block how steps are divided; null: for the other kernels.
  const PartTable* parts = nullptr;
  const StepDivision* division = nullptr;
  /// The store holds values beyond the ends of `pairs`: segments that cross an end of the table are split
  /// there.
  bool values_beyond = false;
  /// With `pairs`: the second sample of a slice segment lies `samples_on` samples further along the ray, plus
  /// `cells_away`. Its position is clamped to the texels held, like all positions at which segments sample.
  float samples_on = 0;
  std::array<float, 3> cells_away{};
  std::array<float, 3> held_low{};
  std::array<float, 3> held_high{};
  const FogTable* fog = nullptr;  ///< null: no fog
  bool cover_whole_ray = false;   ///< as in RaySteps
  Operator op = Operator::over;
  Filter filter = Filter::linear;
  float termination = 0;
  float opacity_limit = 1;           ///< as in RenderRequest
  std::array<float, 3> top{};        ///< positions are clamped to [0, top]
  std::array<float, 3> rounding{};   ///< bounds of the rounding errors of positions
  std::array<bool, 3> has_border{};  ///< axes on which the border colour shows beyond [0, cells]
};

/// Early termination is tested once per this many samples, so that addresses need not wait for opacities.
constexpr int samples_between_tests = 8;

struct KernelCounts {
  std::uint64_t samples_taken = 0;
  std::uint64_t rays_terminated = 0;
  std::uint64_t samples_hidden = 0;  ///< remaining samples of the terminated rays
};

/// Writes the pixel of ray r to rgba + 4 r.
using Kernel = void (*)(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

void generic_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

/// Uses the best instruction set of this machine that Highway supports; falls back to the generic kernel.
void vector_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

/// The same two for segments.
void generic_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
void vector_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
/// Called by vector_segments() for pre-integrated scenes.
void vector_pre_integrated_segments(const Scene& scene, const RayPacket& packet, float* rgba,
                                    KernelCounts& counts);

/// The same two for adaptive steps.
void generic_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
void vector_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

}  // namespace understudy::volume
