// SPDX-License-Identifier: Apache-2.0
// Reads and writes the default framebuffer, and leaves the state of its context unchanged.
#pragma once

#include <cstdint>
#include <vector>

#include "dispatch/table.h"
#include "spu/window_system/window_system.h"

namespace understudy::spu {

/// Returns the lower left `extent` of what the current context shows or is about to show: RGBA with 8 bits,
/// rows from the bottom.
std::vector<std::uint8_t> shown_image(const DispatchTable& gl, Extent2D extent);
/// Returns `count` rows of it, from row `first` on.
std::vector<std::uint8_t> shown_rows(const DispatchTable& gl, int width, int first, int count);

/// Depth and stencil of a cleared window, in one word.
constexpr std::uint32_t far_away = 0xffff'ff00U;

/// All buffers of a default framebuffer except the accumulation buffer.
struct WindowContents {
  Extent2D extent;
  std::vector<std::uint8_t> colours;         ///< in the format of shown_image()
  std::vector<std::uint32_t> depth_stencil;  ///< GL_UNSIGNED_INT_24_8; empty without depth and stencil
};

/// The contents of a cleared window: black, at the far plane.
WindowContents cleared_contents(Extent2D extent, bool depth_stencil);
/// Reads the current context's window. `depth_stencil` requires 24 bits of depth and 8 of stencil.
WindowContents window_contents(const DispatchTable& gl, Extent2D extent, bool depth_stencil);
/// Writes the contents to the current context's window, which must have depth and stencil if they do.
void set_window_contents(const DispatchTable& gl, const WindowContents& contents);

}  // namespace understudy::spu
