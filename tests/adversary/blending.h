// SPDX-License-Identifier: Apache-2.0
// The ways in which volume viewers compose.
#pragma once

#include "tests/adversary/gl.h"

namespace adversary {

enum class Blending { over, premultiplied_over, under, maximum, minimum, sum, off };

void set_blending(const Gl& gl, Blending blending);

}  // namespace adversary
