// SPDX-License-Identifier: Apache-2.0
// How requests, messages and services name a volume.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// Chosen by the client of a render service; each client has numbers of its own.
using VolumeId = std::uint64_t;

}  // namespace understudy::volume
