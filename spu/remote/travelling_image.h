// SPDX-License-Identifier: Apache-2.0
// An image of a GL server on its way over TCP: the coding of its pixels, followed by the GL server's message,
// in which the pixels may be replaced by a JPEG image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spu/remote/gl_server_protocol.h"

namespace understudy::spu {

enum class PixelCoding : std::uint64_t { plain, jpeg, last = jpeg };

/// Restores the message of the GL server. Throws compositor::MalformedMessage.
std::vector<std::byte> decode_travelling_image(std::span<const std::byte> payload);

}  // namespace understudy::spu
