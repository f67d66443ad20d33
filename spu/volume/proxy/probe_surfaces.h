// SPDX-License-Identifier: Apache-2.0
// What probes draw into and read depth from, kept from frame to frame: a ray caster is probed in every frame in
// which the camera moves, and creating these takes longer than the probes.
#pragma once

#include <array>
#include <vector>

#include "spu/volume/context/context.h"

namespace understudy::spu {

class ProbeSurfaces {
 public:
  explicit ProbeSurfaces(const GlContext& context) : gl_(*context.gl) {}
  ~ProbeSurfaces();
  ProbeSurfaces(const ProbeSurfaces&) = delete;
  ProbeSurfaces& operator=(const ProbeSurfaces&) = delete;

  /// Binds a framebuffer of floats, with depth, of at least this size. Its contents are undefined. Returns 0 if
  /// the driver cannot draw into floats.
  GLuint bind_framebuffer(int width, int height);
  /// Binds a depth texture of this size that is 1 everywhere to GL_TEXTURE_2D of the active unit.
  void bind_far_plane(int width, int height);

 private:
  struct FarPlane {
    std::array<int, 2> size;
    GLuint texture;
  };

  const DispatchTable& gl_;
  std::array<int, 2> extent_{};
  GLuint colour_ = 0;
  GLuint depth_ = 0;
  GLuint framebuffer_ = 0;
  bool complete_ = false;
  std::vector<FarPlane> far_planes_;
};

}  // namespace understudy::spu
