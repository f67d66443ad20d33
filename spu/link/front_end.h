// The window system where the application is, as far as the link needs it. What it is asked concerns the
// calling thread's context.
#pragma once

#include <cstdint>
#include <span>

#include "spu/player/window_system.h"

namespace understudy::spu {

struct FrontDrawable {
  std::uint64_t number = 0;  ///< 0: none
  Extent2D extent;
};

class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  /// What the application asked for; number and shares_with are not set.
  virtual RecordedContext context() = 0;
  virtual FrontDrawable drawable() = 0;
  /// In the drawable. Rows from the top, 4 bytes a pixel: blue, green, red, unused.
  virtual void show(Extent2D extent, std::span<const std::uint8_t> pixels) = 0;
};

}  // namespace understudy::spu
