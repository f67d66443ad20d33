// SPDX-License-Identifier: Apache-2.0
// Sampling parameters of a texture: those of its sampler object if there is one, otherwise its own.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// Returns the sampler object of the active unit; 0: there is none.
GLint bound_sampler(const GlContext& context);

/// Returns a parameter of `sampler` or, if it is 0, of the texture that is bound to `target` of the active
/// unit.
GLint texture_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name);

}  // namespace understudy::spu
