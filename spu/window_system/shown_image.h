// SPDX-License-Identifier: Apache-2.0
// The default framebuffer as bytes, and back, without a trace in the context that shows it.
#pragma once

#include <cstdint>
#include <vector>

#include "dispatch/table.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

/// RGBA with 8 bits, rows bottom up, of the lower left `extent` of what the current context shows or is about
/// to show.
std::vector<std::uint8_t> shown_image(const DispatchTable& gl, Extent2D extent);
/// `count` rows of it, from row `first` on.
std::vector<std::uint8_t> shown_rows(const DispatchTable& gl, int width, int first, int count);

/// Of depth and stencil in one word.
constexpr std::uint32_t far_away = 0xffff'ff00U;

/// All of a default framebuffer but what accumulates.
struct WindowContents {
  Extent2D extent;
  std::vector<std::uint8_t> colours;         ///< as shown_image() has them
  std::vector<std::uint32_t> depth_stencil;  ///< GL_UNSIGNED_INT_24_8; empty where there is neither
};

/// As a cleared window has them: black, far away.
WindowContents cleared_contents(Extent2D extent, bool depth_stencil);
/// Of the current context's window. The depth is asked for only where there are 24 bits of it and 8 of stencil.
WindowContents window_contents(const DispatchTable& gl, Extent2D extent, bool depth_stencil);
/// Puts them into the current context's window, which has depth and stencil if they do.
void set_window_contents(const DispatchTable& gl, const WindowContents& contents);

}  // namespace understudy::spu
