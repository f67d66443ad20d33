// SPDX-License-Identifier: Apache-2.0
// Lets `understudy ctl` look at this process and change what it does, from the end of a frame on
// (spu/control/control_server.h).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "spu/control/control_server.h"
#include "spu/volume/session/live_settings.h"
#include "spu/volume/session/render_session.h"

namespace understudy::interceptor {

class ViewerControl {
 public:
  /// Opens this process's socket. Throws std::exception: why the process cannot be controlled.
  explicit ViewerControl(std::shared_ptr<spu::RenderSession> session);

  /// Called when the program ends.
  void stop() noexcept;
  /// Called in a forked child.
  void leave_to_parent() noexcept { server_->leave_to_parent(); }

 private:
  std::string answer(std::string_view line);

  const std::shared_ptr<spu::RenderSession> session_;
  const std::string since_;     ///< UTC
  const std::string obstacle_;  ///< why nothing can be changed; empty: it can
  std::unique_ptr<spu::ControlServer> server_;
};

}  // namespace understudy::interceptor
