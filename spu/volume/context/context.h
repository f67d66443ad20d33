// SPDX-License-Identifier: Apache-2.0
// What the volume unit must know about its context.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext {
  const DispatchTable* gl = nullptr;  ///< dispatch table below the volume unit
  int version = 0;                    ///< 100 * major + 10 * minor, e.g. 450
  bool core = false;                  ///< no fixed function, no GL_FEEDBACK
  bool pipeline_statistics = false;   ///< has the queries of GL_ARB_pipeline_statistics_query
  bool fragment_assembly = false;     ///< GL_ARB_fragment_program
  bool vertex_assembly = false;       ///< GL_ARB_vertex_program
  bool fog_distance = false;          ///< GL_NV_fog_distance
  bool anisotropic_filter = false;    ///< GL_TEXTURE_MAX_ANISOTROPY
  bool program_pipelines = false;     ///< OpenGL 4.1 or GL_ARB_separate_shader_objects
  bool srgb_decode = false;           ///< GL_EXT_texture_sRGB_decode
  std::vector<std::string>
      extensions{};              ///< of the driver, such as GL_ARB_gpu_shader5; empty before OpenGL 3.0
  int fixed_function_units = 0;  ///< texture units of the fixed-function pipeline; 0 in core profiles

  /// Probing and presenting need float framebuffers, GLSL 1.30 and vertex array objects.
  bool sufficient() const { return version >= 300; }
};

/// Returns whether the driver has the extension; false before OpenGL 3.0.
bool has_extension(const GlContext& context, std::string_view name);

/// Queries the current context.
GlContext describe_context(const DispatchTable& gl);

}  // namespace understudy::spu
