// SPDX-License-Identifier: Apache-2.0
// How many bytes stand behind a pointer argument, as far as the call alone tells: the rules of
// spu/dispatch/arguments.txt. Images in client memory depend on the pixel store and are pixels.h's business.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "dispatch/call_shape.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {

/// Nothing when the rule does not tell, or when the numbers make no size. `words` are the call's arguments,
/// pointers as addresses; strings are measured, so theirs must be readable.
std::optional<std::size_t> pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// Rules under which the extent is unknown only where OpenGL does not know an enumerant, and so reads nothing.
bool tells_by_enumerant(ExtentRule rule) noexcept;

/// The same as pointee_bytes, without looking at strings: the least that a string has is its zero.
std::optional<std::size_t> least_pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// Bytes of one vertex array component or index of this type; 0 for types that OpenGL does not have.
std::size_t component_size(GLenum type) noexcept;

/// The argument that has this name in the registry; no_argument when none has.
std::uint8_t argument_named(const CallShape& shape, std::string_view name) noexcept;

/// What a command with an image, image_out or one_texel argument says of its image.
ImageShape image_shape(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
