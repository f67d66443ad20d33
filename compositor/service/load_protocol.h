// SPDX-License-Identifier: Apache-2.0
// Messages that tell nodes to read a volume from a file, and their replies. Their place in a connection:
// node_protocol.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compositor/service/loading_service.h"
#include "compositor/transport/message.h"
#include "volume/brick/histogram.h"
#include "volume/volume_id.h"

namespace understudy::compositor {

enum class LoadMessage : std::uint16_t {
  load_volume = 1,  ///< from an application to rank 0
  continue_load,    ///< likewise
  loading,          ///< the reply to both
  histogram,        ///< how often values occur: from an application to rank 0
  counted,          ///< the reply
  last = counted
};

constexpr Protocol protocol_of(LoadMessage) {
  return {3, 17, std::uint16_t(LoadMessage::last)};
}

struct HistogramQuestion {
  volume::VolumeId volume = 0;
  volume::HistogramBins bins;
};

std::vector<std::byte> encode(const LoadRequest& request);
std::vector<std::byte> encode(const HistogramQuestion& question);
/// The number of texels in each bin.
std::vector<std::byte> encode_histogram(std::span<const std::uint64_t> counts);
std::vector<std::byte> encode(std::span<const RankLoad> ranks);

// All throw MalformedMessage.
LoadRequest decode_load_request(std::span<const std::byte> payload);
std::vector<RankLoad> decode_loads(std::span<const std::byte> payload);
HistogramQuestion decode_histogram_question(std::span<const std::byte> payload);
std::vector<std::uint64_t> decode_histogram(std::span<const std::byte> payload);

}  // namespace understudy::compositor
