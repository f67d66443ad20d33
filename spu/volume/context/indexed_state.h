// SPDX-License-Identifier: Apache-2.0
// State that the application has given to single draw buffers and viewports. Commands without an index, which
// all of our drawing uses, set it for all of them.
#pragma once

#include <array>
#include <vector>

#include "dispatch/table.h"

namespace understudy::spu {

struct GlContext;

/// Reads the state of all draw buffers and viewports, and restores it in its destructor.
class IndexedState {
 public:
  explicit IndexedState(const GlContext& context);
  ~IndexedState();
  IndexedState(const IndexedState&) = delete;
  IndexedState& operator=(const IndexedState&) = delete;

 private:
  struct DrawBuffer {
    std::array<GLboolean, 4> mask{};
    GLboolean blends = GL_FALSE;
    std::array<GLint, 4> factors{};    ///< source and destination of colour, then of alpha; from OpenGL 4.0 on
    std::array<GLint, 2> equations{};  ///< of colour and alpha; from OpenGL 4.0 on
  };
  struct Viewport {
    std::array<GLfloat, 4> place{};
    std::array<GLint, 4> scissor{};
    GLboolean scissors = GL_FALSE;
  };

  const DispatchTable& gl_;
  int version_;
  std::vector<DrawBuffer> draw_buffers_;  ///< from OpenGL 3.0 on
  std::vector<Viewport> viewports_;       ///< from OpenGL 4.1 on
};

}  // namespace understudy::spu
