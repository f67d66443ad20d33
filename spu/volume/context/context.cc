// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/context/context.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace understudy::spu {
namespace {

/// Requires OpenGL 3.0.
std::vector<std::string> extensions_of(const DispatchTable& gl) {
  std::vector<std::string> extensions;
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* extension = reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, GLuint(i)));
    if (extension != nullptr) extensions.emplace_back(extension);
  }
  return extensions;
}

}  // namespace

bool has_extension(const GlContext& context, std::string_view name) {
  return std::ranges::find(context.extensions, name) != context.extensions.end();
}

GlContext describe_context(const DispatchTable& gl) {
  GlContext context;
  context.gl = &gl;
  // The version string exists in every version; GL_MAJOR_VERSION would raise an error before 3.0.
  int major = 0;
  int minor = 0;
  const auto* text = reinterpret_cast<const char*>(gl.GetString(GL_VERSION));
  if (text != nullptr && std::sscanf(text, "%d.%d", &major, &minor) == 2)
    context.version = 100 * major + 10 * minor;
  if (context.version >= 320) {
    GLint mask = 0;
    gl.GetIntegerv(GL_CONTEXT_PROFILE_MASK, &mask);
    context.core = (mask & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
  } else if (context.version >= 310) {
    context.core = true;  // 3.1 without ARB_compatibility; with it Mesa reports 3.2 or later
  }
  if (context.version >= 300) context.extensions = extensions_of(gl);
  context.pipeline_statistics =
      context.version >= 460 || has_extension(context, "GL_ARB_pipeline_statistics_query");
  context.anisotropic_filter = context.version >= 460 ||
                               has_extension(context, "GL_EXT_texture_filter_anisotropic") ||
                               has_extension(context, "GL_ARB_texture_filter_anisotropic");
  context.program_pipelines =
      context.version >= 410 || has_extension(context, "GL_ARB_separate_shader_objects");
  context.srgb_decode = has_extension(context, "GL_EXT_texture_sRGB_decode");
  if (!context.core) {
    gl.GetIntegerv(GL_MAX_TEXTURE_UNITS, &context.fixed_function_units);
    context.fragment_assembly = has_extension(context, "GL_ARB_fragment_program");
    context.fog_distance = has_extension(context, "GL_NV_fog_distance");
    context.vertex_assembly = has_extension(context, "GL_ARB_vertex_program");
  }
  return context;
}

}  // namespace understudy::spu
