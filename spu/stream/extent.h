// SPDX-License-Identifier: Apache-2.0
// The number of bytes behind a pointer argument, as far as the call alone determines it: the rules of
// spu/dispatch/arguments.txt. Images in client memory depend on the pixel store and are handled in pixels.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "dispatch/call_shape.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {

/// Returns nothing if the rule does not determine the size, or if the arguments are invalid. `words` are the
/// call's arguments, pointers as addresses; strings must be readable, because their length is measured.
std::optional<std::size_t> pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// Rules whose extent is only unknown if OpenGL does not know an enumerant, and therefore reads nothing.
bool tells_by_enumerant(ExtentRule rule) noexcept;

/// As pointee_bytes, but without reading strings: their minimum is the terminating zero.
std::optional<std::size_t> least_pointee_bytes(CallId call, std::size_t parameter, const std::uint64_t* words);

/// Bytes of one vertex array component or index of this type; 0 for types unknown to OpenGL.
std::size_t component_size(GLenum type) noexcept;

/// The position of the argument with this name in the registry; no_argument if there is none.
std::uint8_t argument_named(const CallShape& shape, std::string_view name) noexcept;

/// The shape of the image of a command with an image, image_out or one_texel argument.
ImageShape image_shape(CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
