// SPDX-License-Identifier: Apache-2.0
// Calls while runs wait for the others of their volume: those that neither see pixels nor change what the
// image will be shown with go by, every other one shows what waits first.
#pragma once

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

bool passes_held_runs(CallId call);
/// The same of glEnable and glDisable.
bool passes_held_runs(GLenum capability);

}  // namespace understudy::spu
