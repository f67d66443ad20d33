// SPDX-License-Identifier: Apache-2.0
// The programs that images are drawn with.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// A program of a vertex and a fragment shader, whose texts have no `#version`; 0 where the driver does not
/// link it. Attribute 0 is the one named `position`, if there is one.
GLuint link_program(const GlContext& context, const char* vertex_source, const char* fragment_source);

}  // namespace understudy::spu
