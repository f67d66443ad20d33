// SPDX-License-Identifier: Apache-2.0
// A GL server's image on its way over TCP: how its pixels are written, and then the message as the GL server
// made it, its pixels perhaps as a JPEG image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spu/remote/gl_server_protocol.h"

namespace understudy::spu {

enum class PixelCoding : std::uint64_t { plain, jpeg, last = jpeg };

/// The message as a GL server makes it. Throws compositor::MalformedMessage.
std::vector<std::byte> decode_travelling_image(std::span<const std::byte> payload);

}  // namespace understudy::spu
