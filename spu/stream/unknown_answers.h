// SPDX-License-Identifier: Apache-2.0
// Memory for answers whose extent the registry does not tell.
#pragma once

#include <cstddef>
#include <cstdint>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// Bytes that the call writes at most through an argument of rule `unknown`. Asks `gl` where the answer is as
/// long as something that the sender has made.
std::size_t room_for_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl);

}  // namespace understudy::spu
