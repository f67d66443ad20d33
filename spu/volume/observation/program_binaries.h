// SPDX-License-Identifier: Apache-2.0
// Program binaries that a viewer kept from an earlier process, as Qt does on disk: there is no source, so what
// they compute is unknown.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Fills a slot that refuses binaries which this process did not get from a program itself, as drivers refuse
/// those of other versions (OpenGL 4.6, 7.5: GL_LINK_STATUS is false then, and applications compile their
/// sources).
void fill_program_binary_slots(DispatchTable& table);

}  // namespace understudy::spu
