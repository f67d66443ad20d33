// SPDX-License-Identifier: Apache-2.0
// Memory for answers whose extent the registry does not specify.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// Returns the maximum number of bytes that the call writes through an argument of rule `unknown`. Queries `gl`
/// if the length depends on an object of the sender.
std::size_t room_for_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl);

}  // namespace understudy::spu
