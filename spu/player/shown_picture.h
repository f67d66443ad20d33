// The default framebuffer as bytes, without a trace in the context that shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "dispatch/table.h"
#include "spu/player/window_system.h"

namespace understudy::spu {

/// RGBA with 8 bits, rows bottom up, of the lower left `extent` of what the current context shows or is about
/// to show.
std::vector<std::uint8_t> shown_picture(const DispatchTable& gl, Extent2D extent);
/// `count` rows of it, from row `first` on.
std::vector<std::uint8_t> shown_rows(const DispatchTable& gl, int width, int first, int count);

}  // namespace understudy::spu
