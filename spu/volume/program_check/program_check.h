// SPDX-License-Identifier: Apache-2.0
// What a program's source must guarantee for its volume to be substituted. Measuring gives the colours for the
// values that were tried; the source determines what else they can depend on (spu/volume/program).
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

/// The names of the program's samplers, by role.
struct SamplerRoles {
  std::vector<std::string> volume;     ///< set to the volume's texture
  std::vector<std::string> idle;       ///< set to a unit without a texture: they return one value everywhere
  std::vector<std::string> mipmapped;  ///< set to a table whose colours depend on the level of detail
  bool operator==(const SamplerRoles&) const = default;
};

/// What a program draws.
enum class Subject : std::uint8_t { slices, ray_caster };

/// What the source implies for the volume, for one assignment of roles and as long as the uniforms that choose
/// between branches keep their values. Only those of the two findings are set that were requested.
struct ProgramFindings {
  program::StageFacts facts;
  SamplerRoles roles;
  std::optional<program::SliceFinding> slices{};
  std::optional<program::RayFinding> ray{};
};

/// The findings about one link of a program. Each takes about as long as a few draws, and is kept.
class ProgramText {
 public:
  /// Returns the findings, with that about `subject`. `extensions` are the driver's, which decide what `#ifdef`
  /// compiles. Null, with the reason in trouble(), if the source cannot be analysed.
  const ProgramFindings* findings(std::span<const std::string> fragment_sources,
                                  std::span<const std::string> extensions, const SamplerRoles& roles,
                                  std::span<const UniformValue> values, Subject subject);
  const std::string& trouble() const { return trouble_; }

 private:
  /// After this many analyses, uniforms are no longer assumed to be constant: some change all the time.
  static constexpr int most_readings = 16;

  bool holds(const SamplerRoles& roles, const std::vector<program::KnownUniform>& known) const;

  std::vector<program::KnownUniform> known_;
  std::optional<ProgramFindings> findings_;
  std::string trouble_;
  int readings_ = 0;
};

/// The findings about the fragment program in assembly language that was analysed last.
class AssemblyText {
 public:
  /// Returns the findings about the pipeline's program, as slices. Null, with the reason in trouble(), if it
  /// cannot be analysed.
  const ProgramFindings* findings(const GlContext& context, const Pipeline& pipeline);
  const std::string& trouble() const { return trouble_; }

 private:
  std::string text_;
  std::optional<ProgramFindings> findings_;
  std::string trouble_;
};

/// Returns the current values of the parameters that the assembly program's colours depend on, in the order of
/// the findings. Throws Refusal, with the name, if one cannot be read.
std::vector<UniformValue> assembly_values(const DispatchTable& gl, const ProgramFindings& findings);

SamplerRoles sampler_roles(const GlContext& context, const Pipeline& pipeline,
                           const std::vector<SamplerUniform>& samplers);

/// Returns why slices may not be substituted, with the variable's name; null: they may. Besides one texel,
/// colours may depend only on what probing measures: one scalar that fades them (fog), or a second texel that
/// `slice_segments` explain. `fragment.coordinate` names the input that addresses the volume.
std::optional<Refusal> refusal_of_slices(const ProgramFindings& findings, const FragmentInputs& fragment,
                                         bool slice_segments);

/// The same for slices whose fragments come from the pipeline's assembly program.
std::optional<Refusal> refusal_of_assembly(const Pipeline& pipeline, const ProgramFindings& findings,
                                           const FragmentInputs& fragment);

/// Returns why a ray caster may not be substituted; null: it may. Refuses what no measurement would show:
/// colours from the pixel's position or from time (RayFinding::data), several texels in one sample unless they
/// form a gradient, tables whose contents are not tracked, and side effects. Branches, discards, guards and
/// ends of loops by position are not refused: every ray caster ends its loop depending on the ray's position,
/// discards pixels outside of its box, and stops when it is opaque, so the source does not distinguish these
/// from a clipping mask. Their effect is measured (numbers of samples, planes, noise: spu/volume/proxy), and
/// what measuring does not explain shows in the comparison of the first image and in sentinels
/// (spu/volume/verification).
std::optional<Refusal> refusal_of_ray_caster(const ProgramFindings& findings);

/// Returns the distance of the neighbours if a ray caster's samples are computed from a texel and its
/// neighbours at constant distances, and tables are addressed by one of them, or by the neighbours alone:
/// central differences, which lighting and gradient opacity need. Null otherwise.
std::optional<program::NeighbourDistance> neighbours_of_gradients(const ProgramFindings& findings);

/// Returns whether the positions of a ray caster's samples depend on earlier texels, as with longer steps
/// through what is transparent: other tables may then move samples.
bool samples_move_samples(const ProgramFindings& findings);

/// Returns the uniforms of slices as inputs of a comparison: the effect of a change is unknown for those that
/// decide about fragments or move samples.
VerificationSchedule::Inputs uniform_inputs(const ProgramFindings& findings,
                                            std::span<const UniformValue> values);

}  // namespace understudy::spu
