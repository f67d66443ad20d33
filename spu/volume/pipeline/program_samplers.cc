// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/program_samplers.h"

#include <string>

#include "spu/volume/pipeline/active_uniform.h"

namespace understudy::spu {
namespace {

bool may_be_of_a_volume_or_table(GLenum type) {
  switch (type) {
    case GL_SAMPLER_1D:
    case GL_SAMPLER_2D:
    case GL_SAMPLER_2D_RECT:
    case GL_SAMPLER_3D:
    case GL_INT_SAMPLER_3D:
    case GL_UNSIGNED_INT_SAMPLER_3D:
      return true;
    default:
      return false;
  }
}

std::vector<SamplerUniform> read_samplers(const DispatchTable& gl, GLuint program) {
  std::vector<SamplerUniform> samplers;
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) return samplers;
  GLint uniforms = 0;
  gl.GetProgramiv(program, GL_ACTIVE_UNIFORMS, &uniforms);
  for (GLint i = 0; i < uniforms; ++i) {
    auto [text, type, size] = active_uniform(gl, program, GLuint(i));
    if (!may_be_of_a_volume_or_table(type)) continue;
    // Arrays are listed by their first element.
    const bool array = text.ends_with("[0]");
    if (array) text.resize(text.size() - 3);
    for (GLint element = 0; element < size; ++element) {
      const std::string each = array ? text + "[" + std::to_string(element) + "]" : text;
      samplers.push_back({each, type, gl.GetUniformLocation(program, each.c_str())});
    }
  }
  return samplers;
}

}  // namespace

const std::vector<SamplerUniform>& ProgramSamplers::of(const DispatchTable& gl, GLuint program,
                                                       std::uint64_t link) {
  auto& [known_link, samplers] = known_[program];
  if (known_link != link) {
    samplers = read_samplers(gl, program);
    known_link = link;
  }
  return samplers;
}

}  // namespace understudy::spu
