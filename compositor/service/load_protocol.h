// The messages by which nodes are told to read a volume from a file, and what they answer. See protocol.h.
#pragma once

#include <span>
#include <vector>

#include "compositor/service/loading_service.h"

namespace understudy::compositor {

std::vector<std::byte> encode(const LoadRequest& request);
std::vector<std::byte> encode(std::span<const RankLoad> ranks);

// Both throw MalformedMessage.
LoadRequest decode_load_request(std::span<const std::byte> payload);
std::vector<RankLoad> decode_loads(std::span<const std::byte> payload);

}  // namespace understudy::compositor
