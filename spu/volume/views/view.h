// SPDX-License-Identifier: Apache-2.0
// Identifies a view: where, and with which masks, a context draws a volume.
#pragma once

#include <array>
#include <cstdint>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// The views of one volume in several windows, viewports, layers or eyes differ in at least one member, unless
/// an application draws one over the other with the same state (drawn_views.h).
struct View {
  const void* context = nullptr;  ///< compared, never dereferenced
  GLuint texture = 0;             ///< of the volume
  std::uintptr_t window = 0;      ///< the X window that the context draws into, or 0
  GLuint framebuffer = 0;
  GLenum buffer = 0;                   ///< GL_DRAW_BUFFER: each eye of a stereo window has its own
  std::array<GLboolean, 4> written{};  ///< GL_COLOR_WRITEMASK: each eye of an anaglyph has its own
  std::array<GLint, 4> viewport{};
  std::array<GLint, 4> scissor{};  ///< all zero while it is disabled

  bool operator==(const View&) const = default;
};

/// Returns the view into which the current context draws the volume of `texture`.
View current_view(const GlContext& context, GLuint texture, std::uintptr_t window);

}  // namespace understudy::spu
