// Scales, biases and maps of the application would colour pixels that are read or uploaded for it.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// As long as it lives, pixels of the current context are transferred as they are. Core profiles have nothing
/// that could change them.
class NeutralPixelTransfer {
 public:
  explicit NeutralPixelTransfer(const DispatchTable& gl);
  ~NeutralPixelTransfer();
  NeutralPixelTransfer(const NeutralPixelTransfer&) = delete;
  NeutralPixelTransfer& operator=(const NeutralPixelTransfer&) = delete;

 private:
  const DispatchTable& gl_;
  const bool core_;
};

}  // namespace understudy::spu
