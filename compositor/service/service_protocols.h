// SPDX-License-Identifier: Apache-2.0
// The protocols of a connection between applications, the launcher and nodes.
#pragma once

#include <array>

#include "compositor/service/launcher_protocol.h"
#include "compositor/service/load_protocol.h"
#include "compositor/service/node_protocol.h"

namespace understudy::compositor {

inline constexpr std::array service_protocols{protocol_of(LauncherMessage{}), protocol_of(NodeMessage{}),
                                              protocol_of(LoadMessage{})};

}  // namespace understudy::compositor
