// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "spu/unit_description.h"

namespace understudy::spu {

extern const UnitDescription volume_description;

}  // namespace understudy::spu
