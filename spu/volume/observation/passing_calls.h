// SPDX-License-Identifier: Apache-2.0
// Selects the calls that may pass while runs wait for others of their volume: those that neither read pixels
// nor change the state with which the image will be shown. Before any other call, the waiting runs are shown.
#pragma once

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

bool passes_held_runs(CallId call);
/// The same for glEnable and glDisable.
bool passes_held_runs(GLenum capability);

}  // namespace understudy::spu
