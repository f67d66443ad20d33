// SPDX-License-Identifier: Apache-2.0
// Calls that draws may stand between, and that no query tells: conditional rendering, where an occlusion
// query's answer decides whether anything is drawn; and, before OpenGL 4.0, transform feedback.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Notes for the volume unit where they begin and end.
void fill_enclosing_call_slots(DispatchTable& table);

}  // namespace understudy::spu
