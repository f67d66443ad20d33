// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_inputs.h"

#include <algorithm>
#include <limits>

#include "spu/volume/proxy/cuts.h"

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

std::size_t components(GLenum type) {
  switch (type) {
    case GL_FLOAT_VEC2:
      return 2;
    case GL_FLOAT_VEC3:
      return 3;
    case GL_FLOAT_VEC4:
    case GL_FLOAT_MAT2:
      return 4;
    case GL_FLOAT_MAT3:
      return 9;
    case GL_FLOAT_MAT4:
      return 16;
    default:
      return 1;
  }
}

}  // namespace

MarchInputs march_inputs(const MarchContext& measured, const ShareGroup& group,
                         std::span<const std::string> tables_of_samples) {
  const DispatchTable& gl = *measured.context.gl;
  const Pipeline& pipeline = measured.run.pipeline();
  MarchInputs inputs;
  inputs.fixed = {measured.range[0], measured.range[1], pipeline.blending.premultiplied ? 1.0F : 0.0F,
                  float(measured.texture.base)};
  for (const int extent : measured.texture.size) inputs.fixed.push_back(float(extent));
  for (const GLint swizzle : measured.texture.swizzle) inputs.fixed.push_back(float(swizzle));
  if (measured.stages.uniform_blocks) inputs.varying.push_back(never_equal);
  const auto record = group.programs().program(pipeline.program);
  inputs.fixed.push_back(record ? float(record->link) : 0.0F);
  for (const StageUniform& uniform : measured.stages.uniforms) {
    if (tells_cuts(uniform.name)) continue;  // measured without
    const GLint location = gl.GetUniformLocation(pipeline.program, uniform.name.c_str());
    if (location < 0) continue;
    std::array<GLfloat, 16> value{};
    gl.GetUniformfv(pipeline.program, location, value.data());
    auto& to = is_scalar(uniform.type) ? inputs.fixed : inputs.varying;
    to.insert(to.end(), value.begin(), value.begin() + std::ptrdiff_t(components(uniform.type)));
  }
  for (const SampledTexture& other : pipeline.others) {
    if (group.is_rendered_to(other.texture)) {  // the opaque geometry's depth, or a table that is drawn
      inputs.varying.push_back(never_equal);
      continue;
    }
    const bool of_samples = std::ranges::any_of(tables_of_samples, [&](const std::string& name) {
      return gl.GetUniformLocation(pipeline.program, name.c_str()) == other.sampler_location;
    });
    if (of_samples) inputs.tables.insert(inputs.tables.end(), {inputs.fixed.size(), inputs.fixed.size() + 1});
    inputs.fixed.push_back(float(other.texture));
    inputs.fixed.push_back(float(group.texture_version(other.texture)));
  }
  return inputs;
}

}  // namespace understudy::spu
