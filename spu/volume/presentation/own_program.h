// SPDX-License-Identifier: Apache-2.0
// Links the programs that images are drawn with.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// Links a program from a vertex and a fragment shader, given without `#version`; 0 if linking fails. Attribute
/// 0 is the one named `position`, if there is one.
GLuint link_program(const GlContext& context, const char* vertex_source, const char* fragment_source);

}  // namespace understudy::spu
