// SPDX-License-Identifier: Apache-2.0
// A request for an image as a message, and the pre-integration tables that requests name by their place.
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

/// A table that the requests that follow may name by its place.
struct KeptPreIntegrationTable {
  int place = 0;  ///< below limits::max_kept_pre_integration_tables
  volume::PreIntegrationTable table;
};

std::vector<std::byte> encode(const KeptPreIntegrationTable& kept);
/// With `table_at`, a pre-integration table is not written but named by the place that it was sent to.
std::vector<std::byte> encode(const volume::RenderRequest& request, std::optional<int> table_at = {});

// Both throw MalformedMessage. What comes back keeps within limits.h.
KeptPreIntegrationTable decode_pre_integration_table(std::span<const std::byte> payload);
/// `kept` by their places; where there is none its edge is 0.
volume::RenderRequest decode_request(std::span<const std::byte> payload,
                                     std::span<const volume::PreIntegrationTable> kept = {});

}  // namespace understudy::compositor
