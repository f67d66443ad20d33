// SPDX-License-Identifier: Apache-2.0
// Sampling parameters of a texture: those of its sampler object if there is one, otherwise its own.
#pragma once

#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// Returns the sampler object of the active unit; 0: there is none.
GLint bound_sampler(const GlContext& context);

/// Returns a parameter of `sampler` or, if it is 0, of the texture that is bound to `target` of the active
/// unit.
GLint texture_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name);

/// Returns whether a texture of an sRGB format is decoded when it is sampled.
bool decodes_srgb(const GlContext& context, GLenum target, GLint sampler);

/// Returns whether the colour at one coordinate depends on how fast the coordinate changes from pixel to pixel:
/// by mipmap levels, by another filter when minified, or by an anisotropic filter. Of the texture of 1 or 2
/// dimensions that `unit` looks up in `target`.
bool depends_on_level_of_detail(const GlContext& context, GLenum target, int unit);

/// Appends how `unit` looks up its texture of 1 or 2 dimensions between texels and beyond its ends, from
/// which levels, which components it returns, and whether it decodes them.
void append_lookup(const GlContext& context, GLenum target, int unit, std::vector<float>& values);

}  // namespace understudy::spu
