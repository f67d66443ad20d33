// SPDX-License-Identifier: Apache-2.0
// Conditional rendering, which no query tells: whether draws take place lies with an occlusion query's answer.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Notes for the volume unit where conditional rendering begins and ends.
void fill_conditional_render_slots(DispatchTable& table);

}  // namespace understudy::spu
