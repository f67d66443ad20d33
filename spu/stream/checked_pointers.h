// SPDX-License-Identifier: Apache-2.0
// What a pointer argument may be in a stream from elsewhere.
#pragma once

#include <string_view>

#include "dispatch/call_shape.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// As far as the argument's rule tells; what is bound decides the rest (Decoder::check_pointers).
bool may_be(const ParameterShape& parameter, ReferenceKind kind) noexcept;

/// "an address of another process": what such a reference is instead.
std::string_view refused_kind(const ParameterShape& parameter, ReferenceKind kind) noexcept;

}  // namespace understudy::spu
