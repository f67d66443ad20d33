// SPDX-License-Identifier: Apache-2.0
// A render request as a message, and pre-integration tables to which requests refer by place.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::compositor {

/// A table to which later requests may refer by its place.
struct KeptPreIntegrationTable {
  int place = 0;  ///< below limits::max_kept_pre_integration_tables
  volume::PreIntegrationTable table;
};

std::vector<std::byte> encode(const KeptPreIntegrationTable& kept);
/// With `table_at`, writes the place to which a pre-integration table was sent, instead of the table.
std::vector<std::byte> encode(const volume::RenderRequest& request, std::optional<int> table_at = {});

// These throw MalformedMessage. Decoded values are within limits.h.
KeptPreIntegrationTable decode_pre_integration_table(std::span<const std::byte> payload);
/// `kept` is by place; an empty place has a table of edge 0.
volume::RenderRequest decode_request(std::span<const std::byte> payload,
                                     std::span<const volume::PreIntegrationTable> kept = {});
/// Whether the image of an encoded request must arrive as it was computed (volume::must_be_exact()). Relays
/// need to know, and have no pre-integration tables to decode the whole request.
bool asks_for_exact_image(std::span<const std::byte> payload);

}  // namespace understudy::compositor
