// SPDX-License-Identifier: Apache-2.0
// Identifies a volume in requests, messages and services.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// Chosen by the client of a render service; each client has its own numbering.
using VolumeId = std::uint64_t;

}  // namespace understudy::volume
