// SPDX-License-Identifier: Apache-2.0
// Finds what changes in a drawable's image from one frame to the next.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "spu/remote/gl_server_protocol.h"

namespace understudy::launcher {

class FrameChanges {
 public:
  /// Returns the smallest rectangle that contains all changes since the last image of this drawable; the whole
  /// image if its extent has changed. `rgba` has its rows bottom up, as OpenGL reads them. The pixels belong to
  /// this object and are valid until the next call.
  spu::ImageChange next(std::uint64_t drawable, spu::Extent2D extent, std::span<const std::uint8_t> rgba);

 private:
  struct Last {
    spu::Extent2D extent;
    std::vector<std::uint32_t> pixels;  ///< rows top down, blue in the lowest byte
  };

  std::map<std::uint64_t, Last> last_;
  std::vector<std::uint32_t> now_;
  std::vector<std::uint32_t> changed_;
};

}  // namespace understudy::launcher
