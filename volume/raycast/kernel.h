// SPDX-License-Identifier: Apache-2.0
// What the kernels share: a packet of rays goes in, premultiplied pixels come out. The generic kernel takes
// every texel type, filter and operator and says plainly what is meant; the others are faster on one
// combination and must give the same image.
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

/// Everything a kernel reads beside its rays. One of `table`, `map` and `pairs` is set, but both tables where
/// `segments` are pre-integrated.
struct Scene {
  const BrickStore* store = nullptr;
  const OccupancyMap* skip = nullptr;
  const TransferTable* table = nullptr;
  const float* bounds = nullptr;  ///< per block what it can add to a maximum (block_bounds()); null: not known
  const LinearMap* map = nullptr;
  const PreIntegrationLookup* pairs = nullptr;
  /// Surfaces, light and pre-integration: the scene is one for the kernels of segments; null: for the others.
  const SegmentScene* segments = nullptr;
  /// Adaptive steps: what their parts show, and per block into how many they are divided; null: for other
  /// kernels.
  const PartTable* parts = nullptr;
  const StepDivision* division = nullptr;
  /// The store holds values beyond the ends of `pairs`: segments between such a value and one within are
  /// parted.
  bool values_beyond = false;
  /// With pairs: the second sample of a segment lies so many samples on, and then away by a vector of cells; it
  /// is clamped to what the store holds, as are all places that segments look at.
  float samples_on = 0;
  std::array<float, 3> cells_away{};
  std::array<float, 3> held_low{};
  std::array<float, 3> held_high{};
  const FogTable* fog = nullptr;  ///< null: the air is clear
  bool cover_whole_ray = false;   ///< as of RaySteps
  Operator op = Operator::over;
  Filter filter = Filter::linear;
  float termination = 0;
  float opacity_limit = 1;           ///< as of RenderRequest
  std::array<float, 3> top{};        ///< positions are clamped to [0, top]
  std::array<float, 3> rounding{};   ///< of positions, bounded
  std::array<bool, 3> has_border{};  ///< axes on which the border colour shows beyond [0, cells]
};

/// Early termination is tested once per so many samples: addresses then do not wait for opacities.
constexpr int samples_between_tests = 8;

struct KernelCounts {
  std::uint64_t samples_taken = 0;
  std::uint64_t rays_terminated = 0;
  std::uint64_t samples_hidden = 0;  ///< that these had left
};

/// Writes the pixel of ray r to rgba + 4 r.
using Kernel = void (*)(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

void generic_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

/// On the best instruction set of this machine that Highway knows; the generic kernel where it knows none.
void vector_kernel(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

/// The same two for segments.
void generic_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
void vector_segments(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
/// Of the latter, the part for scenes that are pre-integrated.
void vector_pre_integrated_segments(const Scene& scene, const RayPacket& packet, float* rgba,
                                    KernelCounts& counts);

/// The same two for adaptive steps.
void generic_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);
void vector_adaptive(const Scene& scene, const RayPacket& packet, float* rgba, KernelCounts& counts);

}  // namespace understudy::volume
