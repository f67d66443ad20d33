// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program_check/program_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/assembly_parameters.h"
#include "spu/volume/program/element_names.h"
#include "spu/volume/texture/texture_parameter.h"

namespace understudy::spu {
namespace {

using program::Influence;
using program::Source;
using program::SourceKind;
using program::StageFacts;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Texels of idle samplers end a path as the volume's do: nothing reaches colours through them.
std::vector<std::string> ends_of_ways(const SamplerRoles& roles) {
  std::vector<std::string> names = roles.volume;
  names.insert(names.end(), roles.idle.begin(), roles.idle.end());
  return names;
}

/// Tables whose contents are tracked (spu/track), and that a probe can sample.
bool is_known_table(const program::SamplerType& type) {
  using program::TextureShape;
  return type.texels == program::TexelType::real && !type.array && !type.shadow && !type.multisample &&
         (type.shape == TextureShape::line || type.shape == TextureShape::plane ||
          type.shape == TextureShape::rectangle);
}

Refusal not_followed(const program::Fetch& fetch) {
  return fmt::format("colours come from '{}', a {}, whose contents are not followed", fetch.sampler,
                     text(fetch.type));
}

/// Whether a texel decides where the fetch looks up, and so how far neighbouring pixels look up from each
/// other, which decides about the level of detail.
bool has_level_by_texels(const StageFacts& facts, const program::Fetch& fetch) {
  if (fetch.function != program::FetchFunction::filtered) return false;
  const auto is_texel = [&](const program::Dependence& dependence) {
    return facts.sources[dependence.source].kind == SourceKind::texel;
  };
  const auto is_of_draw = [&](const program::Dependence& dependence) {
    const SourceKind kind = facts.sources[dependence.source].kind;
    return kind == SourceKind::uniform || kind == SourceKind::uniform_block;
  };
  if ((fetch.level || fetch.gradient) && std::ranges::all_of(fetch.modifiers, is_of_draw)) return false;
  return std::ranges::any_of(fetch.coordinate, [&](const program::Dependences& component) {
    return std::ranges::any_of(component, is_texel);
  });
}

bool may_be_among(const std::vector<std::string>& samplers, const std::string& name) {
  return std::ranges::any_of(samplers, [&](const std::string& sampler) {
    return name.empty() || program::may_be_same_element(sampler, name);
  });
}

std::optional<Refusal> refusal_of_tables(const StageFacts& facts, const std::vector<std::string>& tables,
                                         const SamplerRoles& roles) {
  for (const program::Fetch& fetch : facts.fetches) {
    if (!contains(tables, fetch.sampler) || contains(roles.idle, fetch.sampler)) continue;
    if (!is_known_table(fetch.type)) return not_followed(fetch);
    if (may_be_among(roles.mipmapped, fetch.sampler) && has_level_by_texels(facts, fetch))
      return Refusal(fmt::format("colours come from '{}', which is mip-mapped, anisotropic, or filtered "
                                 "differently when minified",
                                 fetch.sampler),
                     {}, "choose the same filter for both, without mipmaps, or limit the table to one level");
  }
  return {};
}

std::optional<Refusal> refusal_of_side_effects(const StageFacts& facts) {
  if (!facts.side_effects.empty())
    return Refusal(fmt::format("the fragment shader writes to '{}'", facts.side_effects.front().name));
  return {};
}

const StageInput* input_of(const FragmentInputs& fragment, const std::string& name) {
  const auto found =
      std::ranges::find_if(fragment.inputs, [&](const StageInput& input) { return is_named(input, name); });
  return found == fragment.inputs.end() ? nullptr : &*found;
}

/// Returns whether the values of the varying, which reaches the volume's coordinate, are captured. Those of
/// shaders are; of what assembly programs read, feedback reports the coordinate alone for every vertex.
bool is_observed(const FragmentInputs& fragment, const Source& varying) {
  const StageInput* const input = input_of(fragment, varying.name);
  return fragment.record != nullptr || (input != nullptr && input->name == fragment.coordinate);
}

/// Returns whether the influence is the same for all fragments of the run, or measured as fog.
bool is_measured(const FragmentInputs& fragment, const Influence& influence, const Source& source) {
  const StageInput* const input = input_of(fragment, source.name);
  if (input == nullptr || input->name == fragment.coordinate) return false;
  const auto index = std::size_t(input - fragment.inputs.data());
  if (index >= fragment.range.low.size()) return false;
  const auto component = std::size_t(source.component);
  if (fragment.range.low[index][component] == fragment.range.high[index][component]) return true;
  // A fade that branches on a scalar (PyMOL's fog) is measured like one that is computed from it.
  return influence.target == program::Target::colour && !influence.through_table;
}

/// Lighting and gradients use several texels in one iteration. Two consecutive loops do not: vispy's second one
/// refines the maximum.
bool mixes_samples(const StageFacts& facts, const program::RayFinding& finding, const SamplerRoles& roles) {
  std::vector<std::size_t> loops;
  return std::ranges::any_of(finding.samples, [&](std::size_t index) {
    const program::Fetch& fetch = facts.fetches[index];
    if (contains(roles.idle, fetch.sampler) || !fetch.loop) return false;
    const bool mixes = std::ranges::any_of(loops, [&](std::size_t other) {
      return program::is_within(facts, *fetch.loop, other) || program::is_within(facts, other, *fetch.loop);
    });
    loops.push_back(*fetch.loop);
    return mixes;
  });
}

/// Returns the fetches of the volume that samples are computed from.
std::vector<std::size_t> fetches_of_samples(const program::RayFinding& finding, const StageFacts& facts,
                                            const SamplerRoles& roles) {
  std::vector<std::size_t> fetches;
  std::ranges::copy_if(finding.samples, std::back_inserter(fetches),
                       [&](std::size_t index) { return !contains(roles.idle, facts.fetches[index].sampler); });
  return fetches;
}

std::string sampler_of_unit(int unit) {
  return fmt::format("texture[{}]", unit);
}

bool reads(const program::Fetch& fetch, const SampledTexture& texture) {
  using program::TextureShape;
  const GLenum target = fetch.type.shape == TextureShape::line    ? GL_TEXTURE_1D
                        : fetch.type.shape == TextureShape::plane ? GL_TEXTURE_2D
                                                                  : GL_TEXTURE_RECTANGLE;
  return texture.target == target && fetch.sampler == sampler_of_unit(texture.unit);
}

/// Returns whether the pipeline lists the texture that the fetch reads.
bool is_listed(const Pipeline& pipeline, const program::Fetch& fetch) {
  return std::ranges::any_of(pipeline.others, [&](const SampledTexture& other) { return reads(fetch, other); });
}

/// Returns the role of the only 3-D texture and of tables. No sampler is idle: the texture without a name may
/// have texels.
SamplerRoles assembly_roles(const GlContext& context, const StageFacts& facts, const Pipeline& pipeline) {
  SamplerRoles roles;
  const std::string volume = sampler_of_unit(pipeline.volume.unit);
  if (std::ranges::any_of(facts.fetches, [&](const program::Fetch& fetch) {
        return fetch.sampler == volume && fetch.type.shape == program::TextureShape::space;
      }))
    roles.volume.push_back(volume);
  for (const SampledTexture& other : pipeline.others) {
    if (std::ranges::any_of(facts.fetches, [&](const program::Fetch& fetch) { return reads(fetch, other); }) &&
        depends_on_level_of_detail(context, other.target, other.unit))
      roles.mipmapped.push_back(sampler_of_unit(other.unit));
  }
  return roles;
}

Refusal of_fragment_shader(const std::string& text) {
  return {"the fragment shader: " + text};
}

}  // namespace

SamplerRoles sampler_roles(const GlContext& context, const Pipeline& pipeline,
                           const std::vector<SamplerUniform>& samplers) {
  const DispatchTable& gl = *context.gl;
  SamplerRoles roles;
  for (const SamplerUniform& sampler : samplers) {
    if (sampler.location == pipeline.volume.sampler_location) {
      roles.volume.push_back(sampler.name);
      continue;
    }
    const auto other = std::ranges::find_if(pipeline.others, [&](const SampledTexture& sampled) {
      return sampled.sampler_location == sampler.location;
    });
    if (other != pipeline.others.end()) {
      if (other->texture == 0)
        roles.idle.push_back(sampler.name);
      else if (depends_on_level_of_detail(context, other->target, other->unit))
        roles.mipmapped.push_back(sampler.name);
      continue;
    }
    GLint unit = 0;
    gl.GetUniformiv(pipeline.program, sampler.location, &unit);
    if (unit == pipeline.volume.unit) roles.volume.push_back(sampler.name);
  }
  return roles;
}

bool ProgramText::holds(const SamplerRoles& roles, const std::vector<program::KnownUniform>& known) const {
  return readings_ > 0 && known == known_ && (!findings_ || findings_->roles == roles);
}

const ProgramFindings* ProgramText::findings(std::span<const std::string> fragment_sources,
                                             std::span<const std::string> extensions, const SamplerRoles& roles,
                                             std::span<const UniformValue> values, Subject subject) {
  std::vector<program::KnownUniform> known;
  if (readings_ < most_readings) {
    for (const UniformValue& value : values) {
      if (value.chooses) known.push_back({std::string(value.name), value.component, value.value});
    }
  }
  if (!holds(roles, known)) {
    ++readings_;
    known_ = std::move(known);
    findings_.reset();
    program::StageFinding read =
        program::analyse(program::Stage::fragment, fragment_sources, known_, extensions);
    if (const auto* failure = std::get_if<program::Failure>(&read)) {
      trouble_ = "the fragment shader is not understood: " + failure->what;
    } else {
      findings_.emplace(ProgramFindings{std::get<program::StageFacts>(std::move(read)), roles});
    }
  }
  if (!findings_) return nullptr;
  const std::vector<std::string> volumes = ends_of_ways(roles);
  if (subject == Subject::slices && !findings_->slices)
    findings_->slices = slice_finding(findings_->facts, volumes);
  if (subject == Subject::ray_caster && !findings_->ray)
    findings_->ray = ray_finding(findings_->facts, volumes);
  return &*findings_;
}

const ProgramFindings* AssemblyText::findings(const GlContext& context, const Pipeline& pipeline) {
  if (text_ != pipeline.assembly) {
    text_ = pipeline.assembly;
    findings_.reset();
    program::StageFinding read = program::analyse_assembly(text_);
    if (const auto* failure = std::get_if<program::Failure>(&read))
      trouble_ = "the fragment program in assembly language is not understood: " + failure->what;
    else
      findings_.emplace(ProgramFindings{std::get<StageFacts>(std::move(read)), {}});
  }
  if (!findings_) return nullptr;
  SamplerRoles roles = assembly_roles(context, findings_->facts, pipeline);
  if (!findings_->slices || !(roles == findings_->roles)) {
    findings_->roles = std::move(roles);
    findings_->slices = slice_finding(findings_->facts, ends_of_ways(findings_->roles));
  }
  return &*findings_;
}

std::optional<Refusal> refusal_of_assembly(const Pipeline& pipeline, const ProgramFindings& findings,
                                           const FragmentInputs& fragment) {
  for (const program::Fetch& fetch : findings.facts.fetches) {
    if (contains(findings.slices->tables, fetch.sampler) && !is_listed(pipeline, fetch))
      return not_followed(fetch);
  }
  return refusal_of_slices(findings, fragment, false);
}

std::vector<UniformValue> assembly_values(const DispatchTable& gl, const ProgramFindings& findings) {
  std::vector<UniformValue> values;
  std::vector<double> parameter;
  for (const program::UniformUse& use : findings.slices->uniforms) {
    const Source& source = findings.facts.sources[use.source];
    const bool state = is_assembly_state(source.name);
    if (state && !values.empty() && values.back().name == source.name) continue;
    parameter = assembly_parameter(gl, source.name);
    if (parameter.empty())
      throw Refusal{
          fmt::format("the fragment program reads '{}', whose changes are not followed", source.name)};
    if (!state) parameter = {parameter[std::size_t(source.component)]};
    for (const double value : parameter) values.push_back({source.name, state ? -1 : source.component, value});
  }
  return values;
}

std::optional<Refusal> refusal_of_slices(const ProgramFindings& findings, const FragmentInputs& fragment,
                                         bool slice_segments) {
  const StageFacts& facts = findings.facts;
  const SamplerRoles& roles = findings.roles;
  if (auto refusal = refusal_of_side_effects(facts)) return refusal;
  const program::SliceFinding& finding = *findings.slices;
  std::vector<std::size_t> texels;
  std::ranges::copy_if(finding.texels, std::back_inserter(texels),
                       [&](std::size_t fetch) { return !contains(roles.idle, facts.fetches[fetch].sampler); });
  if (texels.empty()) return "no colour of the fragment shader depends on the volume's texels";
  const std::size_t most = slice_segments ? 2 : 1;
  if ((texels.size() > most || finding.texels_vary_in_loop) && !finding.reasons.empty())
    return of_fragment_shader(finding.reasons.front());
  if (auto refusal = refusal_of_tables(facts, finding.tables, roles)) return refusal;
  std::vector<Influence> unexplained = finding.coordinate_others;
  for (const Influence& influence : finding.others) {
    const Source& source = facts.sources[influence.source];
    if (source.kind == SourceKind::varying && is_measured(fragment, influence, source)) continue;
    unexplained.push_back(influence);
  }
  std::ranges::copy_if(
      finding.coordinate_varyings, std::back_inserter(unexplained),
      [&](const Influence& influence) { return !is_observed(fragment, facts.sources[influence.source]); });
  if (unexplained.empty()) return {};
  return of_fragment_shader(texts(facts, unexplained).front());
}

std::optional<Refusal> refusal_of_ray_caster(const ProgramFindings& findings) {
  const StageFacts& facts = findings.facts;
  if (auto refusal = refusal_of_side_effects(facts)) return refusal;
  const program::RayFinding& finding = *findings.ray;
  if (!finding.loop) return "no loop of the fragment shader samples the volume";
  if (auto refusal = refusal_of_tables(facts, finding.tables, findings.roles)) return refusal;
  std::vector<Influence> unexplained = finding.data;
  if (mixes_samples(facts, finding, findings.roles)) {
    if (!neighbours_of_gradients(findings))
      return "the fragment shader: a sample's colour depends on several texels of the volume (gradient, "
             "lighting)";
    // Lighting depends on a direction: its effect on slopes is measured on several rays.
    std::erase_if(unexplained, [&](const Influence& influence) {
      return facts.sources[influence.source].kind == SourceKind::varying;
    });
  }
  if (!unexplained.empty()) return of_fragment_shader(texts(facts, unexplained).front());
  return {};
}

std::optional<program::NeighbourDistance> neighbours_of_gradients(const ProgramFindings& findings) {
  const StageFacts& facts = findings.facts;
  const std::vector<std::size_t> fetches = fetches_of_samples(*findings.ray, facts, findings.roles);
  if (fetches.size() < 2 || !address_tables_alone(facts, fetches, findings.ray->tables_of_gradients))
    return std::nullopt;
  return neighbour_distance(facts, fetches);
}

bool samples_move_samples(const ProgramFindings& findings) {
  return std::ranges::any_of(findings.ray->coordinates, [&](const Influence& influence) {
    const Source& source = findings.facts.sources[influence.source];
    return influence.flow != program::Flow::loop && source.kind == SourceKind::texel &&
           contains(findings.roles.volume, source.name);
  });
}

VerificationSchedule::Inputs uniform_inputs(const ProgramFindings& findings,
                                            std::span<const UniformValue> values) {
  const auto only_colours = [&](const UniformValue& value) {
    return !value.chooses &&
           std::ranges::none_of(findings.slices->uniforms, [&](const program::UniformUse& use) {
             const Source& source = findings.facts.sources[use.source];
             if (!use.discard && !use.branch && !use.coordinate) return false;
             if (value.name.empty()) return source.kind == SourceKind::uniform_block;
             return (value.component < 0 || source.component == value.component) &&
                    program::may_be_same_element(source.name, value.name);
           });
  };
  using Effect = VerificationSchedule::Effect;
  VerificationSchedule::Inputs inputs;
  for (const UniformValue& value : values) {
    for (const float number : value.floats())
      inputs.push_back({number, only_colours(value) ? Effect::measured : Effect::unknown});
  }
  return inputs;
}

}  // namespace understudy::spu
