// SPDX-License-Identifier: Apache-2.0
// How many bytes the pointer arguments of a call stand for, images included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// Nothing when it is not known. Images are counted without gaps between their rows. 0 for a null pointer.
std::optional<std::size_t> argument_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// What a call hands to OpenGL, or has OpenGL write, through all of its pointers; what is not known counts
/// nothing.
std::uint64_t call_bytes(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
