// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dispatch/table.h"
#include "volume/blending_operator.h"

namespace understudy::spu {

/// Sets the blending that puts an image made with `op` where its samples would have been blended one by one.
void set_image_blending(const DispatchTable& gl, volume::Operator op);

}  // namespace understudy::spu
