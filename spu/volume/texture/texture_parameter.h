// SPDX-License-Identifier: Apache-2.0
// How a texture is looked up: as its sampler object says where it has one, or as it says itself.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// The sampler object of the active unit; 0: there is none.
GLint bound_sampler(const GlContext& context);

/// Of the texture that is bound to `target` of the active unit.
GLint texture_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name);

}  // namespace understudy::spu
