// SPDX-License-Identifier: Apache-2.0
// Ray casters that begin every ray a fraction of a step later than its neighbours, by a noise texture.
//
// Which texture that is, and what its numbers mean, is found by binding others in its place. Under a texture of
// one number, all rays begin alike. Under zeros and ones, the counts of samples show by how much they are
// moved. A random pattern of both shows whether the pixel (x, y) reads the texel (x mod width, y mod height).
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/sample_places.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Returns the texture's own numbers, whatever is bound in its place; null for textures that hold no noise:
/// tables, depths and images.
std::optional<volume::RayOffsets> noise_in(const GlContext& context, const SampledTexture& texture);

/// The sampler from which a program reads by what fraction of a step a ray begins later, linear in the texel.
struct Jitter {
  GLint sampler_location = -1;
  double steps_per_unit = 1;
  bool moves_only = false;  ///< the number of samples is the same as without it
};

/// Returns counted rays, in the same order every time, or why they cannot be counted.
using RayCounting = std::function<std::variant<std::vector<CountedRay>, std::string>()>;

struct JitterFinding {
  Jitter jitter;
  std::vector<StepFit> fits;  ///< of rays at which the texture is zero
};

/// Finds the texture of `run` that moves the samples; null if there is none. `own` was counted under its own
/// numbers; steps may have one length in one of `spaces` (fit_steps). On success, `probe` shows zeros in its
/// place afterwards.
std::optional<JitterFinding> find_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RayCounting& count, const std::vector<CountedRay>& own,
                                         std::span<const volume::Vec3> spaces);

/// Returns rays through split fields; empty if they cannot be counted.
using RaySplitting = std::function<std::vector<SplitRays>()>;

/// Likewise for a texture that moves samples without changing their number, which only split fields show. Rays
/// at which it is zero must march by one of `rules`. Afterwards `probe` shows the texture itself.
std::optional<Jitter> find_moving_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RaySplitting& split, const RaysThroughBox& rays,
                                         const std::vector<volume::RaySteps>& rules);

/// Makes all rays of `probe` begin alike, as under a texture of one number. False if the program has no such
/// texture.
bool begin_rays_at(const Run& run, FieldProbe& probe, const Jitter& jitter, float number);

/// Likewise, with the number zero.
bool hold_still(const Run& run, FieldProbe& probe, const Jitter& jitter);

/// Makes rays begin by the program's own numbers again. False if it has no such texture.
bool show_own_noise(const Run& run, FieldProbe& probe, const Jitter& jitter);

/// Returns the offsets, in steps, of every pixel by the program's own texture; null if it cannot be read.
std::optional<volume::RayOffsets> ray_offsets(const GlContext& context, const Run& run, const Jitter& jitter);

}  // namespace understudy::spu
