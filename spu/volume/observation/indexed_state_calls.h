// SPDX-License-Identifier: Apache-2.0
// Notes whether the application has given single draw buffers or viewports a state of their own.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Overrides the commands that do so.
void fill_indexed_state_slots(DispatchTable& table);

}  // namespace understudy::spu
