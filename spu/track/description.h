// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "spu/unit_description.h"

namespace understudy::spu {

extern const UnitDescription track_description;

}  // namespace understudy::spu
