// A stage's picture on its way over TCP: how its pixels are written, and then the message as the stage made it,
// its pixels perhaps as a JPEG picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "spu/link/stage_protocol.h"

namespace understudy::spu {

enum class PixelCoding : std::uint64_t { plain, jpeg, last = jpeg };

/// The message as a stage makes it. Throws compositor::MalformedMessage.
std::vector<std::byte> decode_travelling_picture(std::span<const std::byte> payload);

}  // namespace understudy::spu
