// SPDX-License-Identifier: Apache-2.0
#include "spu/driver/driver.h"

namespace understudy::spu {

constinit const UnitDescription driver_description{.name = "driver",
                                                   .help = "calls the real OpenGL; the last unit of a chain",
                                                   .position = UnitPosition::last};

}  // namespace understudy::spu
