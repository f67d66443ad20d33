// SPDX-License-Identifier: Apache-2.0
// The local window system of the application, as far as the remote unit needs it.
#pragma once

#include <cstdint>
#include <span>

#include "spu/window_system/window_system.h"

namespace understudy::spu {

struct FrontDrawable {
  std::uint64_t number = 0;  ///< 0: none
  Extent2D extent;
  std::uint64_t screen = 0;  ///< the drawable's screen, in the front end's terms; 0: not visible
};

class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// The format requested for the calling thread's context; number and shares_with are not set.
  virtual RecordedContext context() = 0;
  /// The drawable of the calling thread.
  virtual FrontDrawable drawable() = 0;
  /// Called on a separate thread, even after the drawable was destroyed. Rows from top to bottom, 4 bytes per
  /// pixel: blue, green, red, unused.
  virtual void show(const FrontDrawable& drawable, Extent2D extent, std::span<const std::uint8_t> pixels) = 0;
};

}  // namespace understudy::spu
