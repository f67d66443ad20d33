// SPDX-License-Identifier: Apache-2.0
// Calls that may enclose draws, and that no query reports: conditional rendering, where the result of an
// occlusion query decides whether anything is drawn; and, before OpenGL 4.0, transform feedback.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Fills slots that record for the volume unit where they begin and end.
void fill_enclosing_call_slots(DispatchTable& table);

}  // namespace understudy::spu
