// SPDX-License-Identifier: Apache-2.0
// The dispatch-table slots of the commands that create and change shaders and programs.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// The same in every phase: none of these commands is ever compiled into a display list.
void fill_program_slots(DispatchTable& table);

}  // namespace understudy::spu
