// SPDX-License-Identifier: Apache-2.0
// A unit of the chain that does what a loaded library's unit says.
#pragma once

#include "spu/plugin/unit_plugin.h"
#include "spu/unit_description.h"

namespace understudy::spu {

/// Gives `plugin` its host.
UnitDescription description_of(UnitPlugin& plugin);

}  // namespace understudy::spu
