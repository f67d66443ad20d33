// SPDX-License-Identifier: Apache-2.0
// The application's end of the connection to a node group, with waiting times that tests can set; service.h
// uses the default ones.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "compositor/service.h"
#include "compositor/service/limits.h"

namespace understudy::compositor {

struct Patience {
  std::chrono::milliseconds connect = limits::reply_patience;  ///< until a node group accepts the application
  std::chrono::milliseconds send = limits::send_patience;      ///< until more of a message has been sent
  std::chrono::milliseconds reply = limits::reply_patience;
  std::chrono::milliseconds render = limits::render_patience;
  /// One step of a load: a compressed file is decompressed up to where a rank's share begins.
  std::chrono::milliseconds load = std::chrono::minutes(10);
};

/// Connects to the launcher at `address`. Throws ServiceLost.
std::unique_ptr<RenderService> remote_render_service(const std::string& address, const Patience& patience);

}  // namespace understudy::compositor
