// SPDX-License-Identifier: Apache-2.0
// Calls that redirect vertex arrays, and queries about them, while a run of slices is open.
//
// Draws from the application's own memory are kept with their vertices (client_arrays.h), so arrays may change
// between the slices of a run. Programs that draw each slice from another array do so, and every stream of
// packed calls does.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

void fill_array_calls(DispatchTable& table);

}  // namespace understudy::spu
