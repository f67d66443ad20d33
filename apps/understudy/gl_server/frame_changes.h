// SPDX-License-Identifier: Apache-2.0
// What is different in a drawable's image from one frame to the next.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "spu/remote/gl_server_protocol.h"

namespace understudy::launcher {

class FrameChanges {
 public:
  /// The smallest rectangle that holds all that changed since the last image of this drawable; all of it for
  /// another extent. `rgba` has rows from the bottom, as OpenGL reads them. The pixels are those of this
  /// object, until the next call.
  spu::ImageChange next(std::uint64_t drawable, spu::Extent2D extent, std::span<const std::uint8_t> rgba);

 private:
  struct Last {
    spu::Extent2D extent;
    std::vector<std::uint32_t> pixels;  ///< rows from the top, blue in the lowest byte
  };

  std::map<std::uint64_t, Last> last_;
  std::vector<std::uint32_t> now_;
  std::vector<std::uint32_t> changed_;
};

}  // namespace understudy::launcher
