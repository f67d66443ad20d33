// SPDX-License-Identifier: Apache-2.0
// Built-in uniforms of GLSL's compatibility profile: state of the context, such as gl_FrontMaterial.diffuse,
// which programs read as uniforms and which has no location to read it by.
#pragma once

#include <string_view>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// Returns four whole numbers that depend on all state of the kind that the uniform `name` shows; NaN, which
/// equals nothing, for kinds that are not known here.
std::vector<double> built_in_uniform(const DispatchTable& gl, std::string_view name);

}  // namespace understudy::spu
