// SPDX-License-Identifier: Apache-2.0
// Which texture an upload changes: asked of the driver, while there are volumes and so somebody wants to know.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Every command that changes the contents of a texture first tells the share group which one it is.
void fill_texture_change_slots(DispatchTable& table);

}  // namespace understudy::spu
