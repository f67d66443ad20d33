// SPDX-License-Identifier: Apache-2.0
#include "spu/driver/driver.h"

namespace understudy::spu {

constinit const UnitDescription driver_description{
    .name = "driver", .help = "the real OpenGL; every chain ends in it", .position = UnitPosition::last};

}  // namespace understudy::spu
