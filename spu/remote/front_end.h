// SPDX-License-Identifier: Apache-2.0
// The window system where the application is, as far as the link needs it.
#pragma once

#include <cstdint>
#include <span>

#include "spu/window_system/window_system.h"

namespace understudy::spu {

struct FrontDrawable {
  std::uint64_t number = 0;  ///< 0: none
  Extent2D extent;
  std::uint64_t screen = 0;  ///< where show() finds it, whatever that means to the front end; 0: nobody sees it
};

class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// Of the calling thread's context: what the application asked for; number and shares_with are not set.
  virtual RecordedContext context() = 0;
  /// The calling thread's.
  virtual FrontDrawable drawable() = 0;
  /// Called by a thread of its own, also when the drawable is gone. Rows from the top, 4 bytes a pixel: blue,
  /// green, red, unused.
  virtual void show(const FrontDrawable& drawable, Extent2D extent, std::span<const std::uint8_t> pixels) = 0;
};

}  // namespace understudy::spu
