// SPDX-License-Identifier: Apache-2.0
// The unit of a chain that forwards to the unit of a loaded library.
#pragma once

#include "spu/plugin/unit_plugin.h"
#include "spu/unit_description.h"

namespace understudy::spu {

/// Describes the unit of `plugin`, and sets the plugin's host.
UnitDescription description_of(UnitPlugin& plugin);

}  // namespace understudy::spu
