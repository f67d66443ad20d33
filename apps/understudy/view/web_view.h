// SPDX-License-Identifier: Apache-2.0
// `understudy view --web`: displays a volume in the browsers of everybody who has the session's secret.
#pragma once

#include <stop_token>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

struct WebAddress {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any free port
};

/// Prints the link, loads the volume and renders for all viewers, one image at a time, until `stop` is
/// requested. If the service is lost, reconnects for as long as necessary. Throws if the volume cannot be
/// loaded the first time, and std::runtime_error if it cannot listen on the address.
void show_on_web(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                 const std::stop_token& stop, const WebAddress& address);

}  // namespace understudy::launcher
