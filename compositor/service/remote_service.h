// SPDX-License-Identifier: Apache-2.0
// The application's end of the connection to a node group, with its patience open to tests; service.h has the
// usual one.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "compositor/service.h"
#include "compositor/service/limits.h"

namespace understudy::compositor {

struct Patience {
  std::chrono::milliseconds connect = limits::reply_patience;  ///< until a node group takes the application in
  std::chrono::milliseconds send = limits::send_patience;      ///< until some more of a message has left
  std::chrono::milliseconds reply = limits::reply_patience;
  std::chrono::milliseconds render = limits::render_patience;
  /// One step of a load: a compressed file is read through up to where a rank's share begins.
  std::chrono::milliseconds load = std::chrono::minutes(10);
};

/// Throws ServiceLost.
std::unique_ptr<RenderService> remote_render_service(const std::string& address, const Patience& patience);

}  // namespace understudy::compositor
