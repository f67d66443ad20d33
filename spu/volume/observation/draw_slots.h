// SPDX-License-Identifier: Apache-2.0
// The slots of the dispatch table that the volume unit fills while it watches, and while a run is open.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Fills the slots of draws and of changes of textures; the others remain those of the next unit.
void fill_watching_slots(DispatchTable& table);

/// Draws join the run as further slices; every other call first closes the run and is then made.
void fill_deferring_slots(DispatchTable& table);

/// Fills the slot of glGetError, which first returns the application's errors that were kept while we made
/// calls of our own. It closes the run, too.
void fill_error_slot(DispatchTable& table);

}  // namespace understudy::spu
