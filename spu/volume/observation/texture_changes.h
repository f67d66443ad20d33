// SPDX-License-Identifier: Apache-2.0
// Determines which texture an upload changes. The driver is queried only while there are volumes.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Fills slots in which every command that changes the contents of a texture first reports it to the share
/// group.
void fill_texture_change_slots(DispatchTable& table);

}  // namespace understudy::spu
