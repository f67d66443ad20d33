// SPDX-License-Identifier: Apache-2.0
// What the volume unit must know about the context it stands in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext {
  const DispatchTable* gl = nullptr;  ///< the table below the volume unit
  int version = 0;                    ///< 100 * major + 10 * minor, e.g. 450
  bool core = false;                  ///< no fixed function, no GL_FEEDBACK
  bool pipeline_statistics = false;   ///< there are queries of GL_ARB_pipeline_statistics_query
  bool fragment_assembly = false;     ///< GL_ARB_fragment_program
  bool vertex_assembly = false;       ///< GL_ARB_vertex_program
  bool fog_distance = false;          ///< GL_NV_fog_distance
  std::vector<std::string>
      extensions{};              ///< the driver's, GL_ARB_gpu_shader5 and so on; of OpenGL 3.0 and later
  int fixed_function_units = 0;  ///< texture units of the fixed-function pipeline; 0 in core profiles

  /// Float framebuffers, GLSL 1.30 and vertex array objects are what probing and presenting need.
  bool sufficient() const { return version >= 300; }
};

/// Whether the driver of an OpenGL 3.0 or later names it.
bool has_extension(const GlContext& context, std::string_view name);

/// Asks the current context.
GlContext describe_context(const DispatchTable& gl);

}  // namespace understudy::spu
