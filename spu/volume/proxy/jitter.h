// SPDX-License-Identifier: Apache-2.0
// Ray casters that begin every ray a part of a step later than its neighbours, by a texture of noise.
//
// Which texture that is, and what its numbers mean, is found by showing others in its place: under a texture of
// one number all rays begin alike, under zeros and ones the counts of samples tell by how much, and a random
// pattern of both, whether the pixel (x, y) reads the texel (x mod width, y mod height).
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

/// The texture's own numbers, whatever is shown in its place; none of textures that hold no noise: tables,
/// depths and images.
std::optional<volume::RayOffsets> noise_in(const GlContext& context, const SampledTexture& texture);

/// Where a program reads by how much of a step a ray begins later: linear in the texel's number.
struct Jitter {
  GLint sampler_location = -1;
  double steps_per_unit = 1;
  bool moves_only = false;  ///< there are as many samples as without
};

/// Counted rays, in the same order every time, or why they cannot be counted.
using RayCounting = std::function<std::variant<std::vector<CountedRay>, std::string>()>;

struct JitterFinding {
  Jitter jitter;
  std::vector<StepFit> fits;  ///< of rays that begin at the texture's zero
};

/// The texture among those of `run` that moves the samples, where there is one; `own` was counted under its own
/// numbers, and steps may have one length in one of `spaces` (fit_steps). Afterwards `probe` shows zeros in its
/// place.
std::optional<JitterFinding> find_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RayCounting& count, const std::vector<CountedRay>& own,
                                         std::span<const volume::Vec3> spaces);

/// Rays through split fields, or none.
using RaySplitting = std::function<std::vector<SplitRays>()>;

/// The same of a texture that moves samples and does not change how many there are, which only split fields
/// tell: rays that begin at its zero march by one of `rules`. Afterwards `probe` shows the texture itself.
std::optional<Jitter> find_moving_jitter(const GlContext& context, const Run& run, FieldProbe& probe,
                                         const RaySplitting& split, const RaysThroughBox& rays,
                                         const std::vector<volume::RaySteps>& rules);

/// Makes all rays of `probe` begin alike, as a texture of one number would have them. False when the program
/// has no such texture.
bool begin_rays_at(const Run& run, FieldProbe& probe, const Jitter& jitter, float number);

/// The same at the jitter's zero.
bool hold_still(const Run& run, FieldProbe& probe, const Jitter& jitter);

/// They begin by the program's own numbers again. False when it has no such texture.
bool show_own_noise(const Run& run, FieldProbe& probe, const Jitter& jitter);

/// What the program's own texture says of every pixel.
std::optional<volume::RayOffsets> ray_offsets(const GlContext& context, const Run& run, const Jitter& jitter);

}  // namespace understudy::spu
