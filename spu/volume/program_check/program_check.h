// SPDX-License-Identifier: Apache-2.0
// What the text of a program must say for its volume to be substituted. Measuring finds what colours are for
// the values that were tried; the text says on what else they can depend (spu/volume/program).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/pipeline/program_stages.h"
#include "spu/volume/program/analysis.h"
#include "spu/volume/program/ray_caster.h"
#include "spu/volume/program/slices.h"
#include "spu/volume/refusal/refusal.h"
#include "spu/volume/verification/schedule.h"

namespace understudy::spu {

/// The names that the program has for textures.
struct SamplerRoles {
  std::vector<std::string> volume;  ///< set to the volume's texture
  std::vector<std::string> idle;    ///< set to a unit without a texture: they give the same everywhere
  bool operator==(const SamplerRoles&) const = default;
};

/// What a program was drawn for.
enum class Subject : std::uint8_t { slices, ray_caster };

/// What the text says about the volume, for one choice of roles and as long as the uniforms that choose between
/// branches keep their values. Of the two findings there are those that were asked for.
struct ProgramFindings {
  program::StageFacts facts;
  SamplerRoles roles;
  std::optional<program::SliceFinding> slices{};
  std::optional<program::RayFinding> ray{};
};

/// The findings of one link of a program. Each takes about as long as a few draws, and is kept.
class ProgramText {
 public:
  /// With the finding about `subject`. `extensions` are the driver's, which decide what `#ifdef` compiles.
  /// Null, with the reason in trouble(), where the text is not understood.
  const ProgramFindings* findings(std::span<const std::string> fragment_sources,
                                  std::span<const std::string> extensions, const SamplerRoles& roles,
                                  std::span<const UniformValue> values, Subject subject);
  const std::string& trouble() const { return trouble_; }

 private:
  /// Later values of uniforms that change all the time are not told to the analysis.
  static constexpr int most_readings = 16;

  bool holds(const SamplerRoles& roles, const std::vector<program::KnownUniform>& known) const;

  std::vector<program::KnownUniform> known_;
  std::optional<ProgramFindings> findings_;
  std::string trouble_;
  int readings_ = 0;
};

SamplerRoles sampler_roles(const DispatchTable& gl, const Pipeline& pipeline,
                           const std::vector<SamplerUniform>& samplers);

/// Why slices may not be substituted, with the variable's name; null: they may. What colours depend on besides
/// one texel must be one of the things that probing measures: one number that fades colours (fog), or a second
/// texel that `slice_segments` explain. `coordinate` names the input that addresses the volume.
std::optional<Refusal> refusal_of_slices(const ProgramStages& stages, const ProgramFindings& findings,
                                         const FragmentInputs& fragment, bool slice_segments);

/// Why a ray caster may not be; null: it may. Refused is what no measurement would show: colours from the
/// pixel's position or from time (RayFinding::data), several texels in one sample (light, gradients), tables
/// that are not followed, and side effects. Branches, discards, guards and ends of loops by position are no
/// refusal: every ray caster ends its loop by where the ray is, leaves pixels out that its box does not cover,
/// and stops where opacity is reached, so that the text cannot tell these from a clipping mask. What they do is
/// measured (counts of samples, planes, noise: spu/volume/proxy), and what measuring does not explain shows in
/// the comparison of the first image and in sentinels (spu/volume/verification).
std::optional<Refusal> refusal_of_ray_caster(const ProgramFindings& findings);

/// How far away the neighbours are where a ray caster's samples are made of a texel and its neighbours at
/// constant distances, and tables are addressed by one of them, or by the neighbours alone: central
/// differences, which light and gradient opacity need. Null: they are not.
std::optional<program::NeighbourDistance> neighbours_of_gradients(const ProgramFindings& findings);

/// Whether where a ray caster takes a sample depends on texels that it met before, as where it takes longer
/// steps through what is transparent: other tables may then move samples.
bool samples_move_samples(const ProgramFindings& findings);

/// Uniforms of slices as inputs of a comparison: what a change of those does that decide about fragments or
/// move samples is unknown.
VerificationSchedule::Inputs uniform_inputs(const ProgramFindings& findings,
                                            std::span<const UniformValue> values);

}  // namespace understudy::spu
