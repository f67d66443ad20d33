// SPDX-License-Identifier: Apache-2.0
// Program binaries that a viewer kept from another run of it, as Qt does on disk: what they compute is not
// known, as there is no source.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// A binary that this process did not take from a program itself is refused, as drivers refuse those of other
/// versions (OpenGL 4.6, 7.5: GL_LINK_STATUS is false then, and applications compile their sources).
void fill_program_binary_slots(DispatchTable& table);

}  // namespace understudy::spu
