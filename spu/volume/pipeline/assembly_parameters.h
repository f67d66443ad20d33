// SPDX-License-Identifier: Apache-2.0
// Reads what a fragment program in assembly language reads besides inputs and texels.
#pragma once

#include <string_view>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

/// Returns the current value of the bound fragment program's "program.local[0]" or "program.env[0]": four
/// components. Of state, such as "state.fog.color", four whole numbers that depend on all state of that kind.
/// Empty if it cannot be read by its name.
std::vector<double> assembly_parameter(const DispatchTable& gl, std::string_view name);

/// Returns whether the parameter is state, which is read as a whole.
bool is_assembly_state(std::string_view name);

}  // namespace understudy::spu
