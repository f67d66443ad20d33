// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_inputs.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>

#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"
#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/program/element_names.h"
#include "spu/volume/proxy/cuts.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/other_inputs.h"
#include "spu/volume/texture/texture_parameter.h"

namespace understudy::spu {
namespace {

constexpr float never_equal = std::numeric_limits<float>::quiet_NaN();

bool is_scalar(GLenum type) {
  switch (type) {
    case GL_FLOAT_VEC2:
    case GL_FLOAT_VEC3:
    case GL_FLOAT_VEC4:
    case GL_FLOAT_MAT2:
    case GL_FLOAT_MAT3:
    case GL_FLOAT_MAT4:
      return false;
    default:
      return true;
  }
}

/// Whether the uniform affects where samples lie and when a ray ends, and decides about no fragment or colour.
/// It may affect colours as a number: programs correct opacity by the step.
bool moves_samples_only(const ProgramFindings& says, const std::string& name) {
  bool moves = false;
  for (const program::UniformUse& use : says.ray->uniforms) {
    const program::Source& source = says.facts.sources[use.source];
    if (source.kind != program::SourceKind::uniform || source.name != name) continue;
    if (use.discard || use.branch) return false;
    moves |= use.coordinate;
  }
  return moves;
}

/// Whether the sampler may have a texture that the application draws into. Volumes and depth textures do not
/// count: probes replace them by fields and the far plane.
bool may_be_drawn(const MarchContext& measured, const ShareGroup& group, const std::string& sampler) {
  const DispatchTable& gl = *measured.context.gl;
  const Pipeline& pipeline = measured.run.pipeline();
  return std::ranges::any_of(pipeline.others, [&](const SampledTexture& other) {
    return group.is_rendered_to(other.texture) && !is_depth_texture(gl, other) &&
           may_be_sampled_by(gl, pipeline.program, sampler, other);
  });
}

}  // namespace

void append_value(const MarchContext& measured, const StageUniform& uniform, std::vector<float>& values) {
  append_uniform(measured.context, measured.run.pipeline().program, uniform, values);
}

bool chooses_colours(const ProgramFindings& says, const std::string& uniform) {
  return std::ranges::any_of(says.ray->uniforms, [&](const program::UniformUse& use) {
    return use.chooses_colour && program::may_be_same_element(says.facts.sources[use.source].name, uniform);
  });
}

void MarchInputs::begin_vector(std::string_view name, bool chooses, bool may_be_step) {
  varying_may_be_step.push_back(may_be_step);
  varying_names.push_back(std::hash<std::string_view>()(name));
  varying_begins.push_back(varying.size());
  varying_chooses.push_back(chooses);
}

MarchInputs march_inputs(const MarchContext& measured, const CoordinateSpace& space, const ShareGroup& group,
                         const ProgramFindings& says) {
  const DispatchTable& gl = *measured.context.gl;
  const Pipeline& pipeline = measured.run.pipeline();
  MarchInputs inputs;
  inputs.fixed = {measured.range[0], measured.range[1], pipeline.blending.premultiplied ? 1.0F : 0.0F,
                  float(measured.texture.base)};
  inputs.fixed.push_back(pipeline.target.floating ? 1.0F : 0.0F);
  inputs.fixed.push_back(pipeline.blending.replaces ? 1.0F : 0.0F);
  // Which faces produce fragments shows only when rays are probed, so it counts as varying.
  GLint culled = 0;
  GLint front = 0;
  gl.GetIntegerv(GL_CULL_FACE_MODE, &culled);
  gl.GetIntegerv(GL_FRONT_FACE, &front);
  const auto varies = [&](std::string_view what, float value) {
    inputs.begin_vector(what, false);
    inputs.varying.push_back(value);
  };
  varies("GL_CULL_FACE_MODE", gl.IsEnabled(GL_CULL_FACE) ? float(culled) : 0.0F);
  varies("GL_FRONT_FACE", float(front));
  // Rays are probed without the alpha test, but images are compared with it.
  if (!measured.context.core) {
    inputs.begin_vector("fragment operations", false);
    append_fragment_operations(gl, inputs.varying);
  }
  for (const int extent : measured.texture.size) inputs.fixed.push_back(float(extent));
  for (const GLint swizzle : measured.texture.swizzle) inputs.fixed.push_back(float(swizzle));
  if (measured.stages.uniform_blocks) varies("uniform blocks", never_equal);
  const auto record = group.programs().program(pipeline.program);
  append_exactly(record ? record->link : 0, inputs.fixed);
  const CutUniforms cuts(measured.context, pipeline.program);
  for (const StageUniform& uniform : measured.stages.uniforms) {
    if (cuts.contains(uniform.name)) {
      append_value(measured, uniform, inputs.cuts);
      continue;
    }
    const std::size_t before = inputs.fixed.size();
    const bool scalar = is_scalar(uniform.type);
    if (!scalar) inputs.begin_vector(uniform.name, chooses_colours(says, uniform.name));
    append_value(measured, uniform, scalar ? inputs.fixed : inputs.varying);
    const bool in_use = inputs.fixed.size() > before;
    if (in_use && uniform.type == GL_FLOAT && moves_samples_only(says, uniform.name))
      inputs.steps.push_back(before);
  }
  for (const SampledTexture& other : pipeline.others) {
    if (group.is_rendered_to(other.texture)) {  // the opaque geometry's depth, or a table that is rendered to
      varies("a texture that is drawn", never_equal);
      continue;
    }
    if (is_depth_texture(gl, other)) {
      append_exactly(other.texture, inputs.depths);
      append_exactly(group.texture_version(other.texture), inputs.depths);
      continue;
    }
    const bool of_samples = std::ranges::any_of(says.ray->tables_of_samples, [&](const std::string& name) {
      return gl.GetUniformLocation(pipeline.program, name.c_str()) == other.sampler_location;
    });
    const std::size_t first = inputs.fixed.size();
    append_exactly(other.texture, inputs.fixed);
    append_exactly(group.texture_version(other.texture), inputs.fixed);
    for (std::size_t i = first; of_samples && i < inputs.fixed.size(); ++i) inputs.tables.push_back(i);
    append_lookup(measured.context, other.target, other.unit, inputs.fixed);
  }
  inputs.of_fragment_stage = inputs.varying.size();
  append_other_inputs(measured, space, says, inputs);
  return inputs;
}

std::vector<float> discard_inputs(const MarchContext& measured, const ShareGroup& group,
                                  const MarchInputs& inputs, const ProgramFindings& says) {
  const auto source = [&](const auto& use) -> const program::Source& { return says.facts.sources[use.source]; };
  std::vector<float> depends;
  for (std::size_t i = 0; i < inputs.fixed.size(); ++i) {
    // No discard depends on these.
    if (std::ranges::find(inputs.steps, i) == inputs.steps.end()) depends.push_back(inputs.fixed[i]);
  }
  const bool on_drawn_texels =
      std::ranges::any_of(says.ray->discards, [&](const program::Influence& influence) {
        const program::Source& texel = source(influence);
        return texel.kind == program::SourceKind::texel && may_be_drawn(measured, group, texel.name);
      });
  if (measured.stages.uniform_blocks || on_drawn_texels) depends.push_back(never_equal);
  for (const StageUniform& uniform : measured.stages.uniforms) {
    const bool decides = std::ranges::any_of(says.ray->uniforms, [&](const program::UniformUse& use) {
      return use.discard && source(use).name == uniform.name;
    });
    if (decides) append_value(measured, uniform, depends);
  }
  return depends;
}

bool same_in_fragment_stage(const MarchInputs& before, const MarchInputs& now) {
  const auto of_fragment_stage = [](const MarchInputs& inputs) {
    return std::span(inputs.varying).first(inputs.of_fragment_stage);
  };
  return before.fixed == now.fixed && before.depths == now.depths &&
         std::ranges::equal(of_fragment_stage(before), of_fragment_stage(now));
}

BesideChange change_beside_fragment_stage(const MarchInputs& before, const MarchInputs& now,
                                          const std::vector<bool>& follows) {
  if (before.varying_names != now.varying_names || before.varying.size() != now.varying.size())
    return BesideChange::alone;
  BesideChange change = BesideChange::none;
  std::size_t vector = 0;
  for (std::size_t i = now.of_fragment_stage; i < now.varying.size(); ++i) {
    while (vector + 1 < now.varying_begins.size() && now.varying_begins[vector + 1] <= i) ++vector;
    if (before.varying[i] == now.varying[i]) continue;
    if (!follows[i]) return BesideChange::alone;
    if (now.varying_may_be_step[vector]) change = BesideChange::with_camera;
  }
  return change;
}

bool only_tables_differ(const MarchInputs& before, const MarchInputs& now) {
  if (before.fixed.size() != now.fixed.size()) return false;
  for (std::size_t i = 0; i < now.fixed.size(); ++i) {
    if (before.fixed[i] != now.fixed[i] && std::ranges::find(now.tables, i) == now.tables.end()) return false;
  }
  return true;
}

bool steps_differ(const MarchInputs& before, const MarchInputs& now) {
  return before.fixed.size() != now.fixed.size() || std::ranges::any_of(now.steps, [&](std::size_t step) {
           return before.fixed[step] != now.fixed[step];
         });
}

std::vector<double> step_factors(const MarchInputs& before, const MarchInputs& now) {
  constexpr double largest = 64;
  if (before.fixed.size() != now.fixed.size()) return {};
  std::vector<double> factors;
  for (std::size_t i = 0; i < now.fixed.size(); ++i) {
    if (before.fixed[i] == now.fixed[i] || std::ranges::find(now.tables, i) != now.tables.end()) continue;
    if (std::ranges::find(now.steps, i) == now.steps.end()) return {};
    const double factor = double(now.fixed[i]) / double(before.fixed[i]);
    if (!(factor > 1 / largest && factor < largest)) return {};
    factors.push_back(factor);
  }
  if (factors.empty()) factors.push_back(1);
  return factors;
}

}  // namespace understudy::spu
