// SPDX-License-Identifier: Apache-2.0
// The kinds of reference that a pointer argument may have in a stream from elsewhere.
#pragma once

#include <string_view>

#include "dispatch/call_shape.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Whether the argument's rule allows this kind; the rest depends on bindings (Decoder::check_pointers).
bool may_be(const ParameterShape& parameter, ReferenceKind kind) noexcept;

/// Describes a reference that is not allowed: "an address of another process".
std::string_view refused_kind(const ParameterShape& parameter, ReferenceKind kind) noexcept;

}  // namespace understudy::spu
