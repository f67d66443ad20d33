// SPDX-License-Identifier: Apache-2.0
// The slots of the dispatch table that the volume unit takes while it watches, and while a run is open.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Draws and changes of textures are looked at; everything else stays the next unit's.
void fill_watching_slots(DispatchTable& table);

/// More slices join the run; every other call closes it first and is then made.
void fill_deferring_slots(DispatchTable& table);

}  // namespace understudy::spu
