// SPDX-License-Identifier: Apache-2.0
// While a run of slices is open: calls that point vertex arrays elsewhere, and questions about them.
//
// Draws from the application's own memory are kept with their vertices (client_arrays.h), so the arrays may
// change between the slices of one run. Programs that draw each slice from another array do that, and so does
// every stream of packed calls.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

void fill_array_calls(DispatchTable& table);

}  // namespace understudy::spu
