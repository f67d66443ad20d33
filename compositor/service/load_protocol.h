// The messages by which nodes are told to read a volume from a file, and what they answer. See protocol.h.
#pragma once

#include <span>
#include <vector>

#include "compositor/service/loading_service.h"
#include "volume/brick/histogram.h"
#include "volume/description.h"

namespace understudy::compositor {

struct HistogramQuestion {
  volume::VolumeId volume = 0;
  volume::HistogramBins bins;
};

std::vector<std::byte> encode(const LoadRequest& request);
std::vector<std::byte> encode(const HistogramQuestion& question);
/// Texels by bin.
std::vector<std::byte> encode_histogram(std::span<const std::uint64_t> counts);
std::vector<std::byte> encode(std::span<const RankLoad> ranks);

// All throw MalformedMessage.
LoadRequest decode_load_request(std::span<const std::byte> payload);
std::vector<RankLoad> decode_loads(std::span<const std::byte> payload);
HistogramQuestion decode_histogram_question(std::span<const std::byte> payload);
std::vector<std::uint64_t> decode_histogram(std::span<const std::byte> payload);

}  // namespace understudy::compositor
