// SPDX-License-Identifier: Apache-2.0
// `understudy view --web`: a volume in the browsers of whoever has the session's secret.
#pragma once

#include <stop_token>
#include <string>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/volume_memory.h"

namespace understudy::launcher {

struct WebAddress {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any
};

/// Prints the link, loads the volume and draws for all viewers, one image at a time, until `stop` is
/// requested. A service that is lost is made again, for as long as it takes. Throws what keeps the volume from
/// being loaded the first time, and std::runtime_error where the address cannot be listened on.
void show_on_web(const FileScene& scene, const ServiceMaker& make, const RankMemory& memory,
                 const std::stop_token& stop, const WebAddress& address);

}  // namespace understudy::launcher
