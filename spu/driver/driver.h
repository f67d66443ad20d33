// SPDX-License-Identifier: Apache-2.0
// The end of every chain: the real OpenGL. It is not a unit; its slots are the driver's own function pointers.
#pragma once

#include "spu/unit_description.h"

namespace understudy::spu {

extern const UnitDescription driver_description;

}  // namespace understudy::spu
