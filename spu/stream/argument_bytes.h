// SPDX-License-Identifier: Apache-2.0
// The number of bytes that the pointer arguments of a call refer to, including images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// Nothing if the size is unknown. Images are counted without gaps between their rows. 0 for a null pointer.
std::optional<std::size_t> argument_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// The bytes that a call reads or writes through all of its pointers; arguments of unknown size count as 0.
std::uint64_t call_bytes(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
