// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fixed_function_texgen() {
  return {
      .sentence = "Fixed function: large quads before the eye, texture coordinates by texgen, six clip planes.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
        return [&canvas](int frame) {
          const Gl& gl = canvas.gl;
          const Camera camera = old_camera(canvas, frame);
          begin_old_frame(canvas, camera);
          gl.Enable(GL_TEXTURE_3D);
          gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
          for (GLenum axis = 0; axis < 3; ++axis) {
            std::array<GLfloat, 4> plane{};
            plane[axis] = 1;
            gl.TexGeni(GL_S + axis, GL_TEXTURE_GEN_MODE, GL_EYE_LINEAR);
            gl.TexGenfv(GL_S + axis, GL_EYE_PLANE, plane.data());
            gl.Enable(GL_TEXTURE_GEN_S + axis);
            std::array<GLdouble, 4> low{}, high{0, 0, 0, 1};
            low[axis] = 1;
            high[axis] = -1;
            gl.ClipPlane(GL_CLIP_PLANE0 + 2 * axis, low.data());
            gl.ClipPlane(GL_CLIP_PLANE1 + 2 * axis, high.data());
            gl.Enable(GL_CLIP_PLANE0 + 2 * axis);
            gl.Enable(GL_CLIP_PLANE1 + 2 * axis);
          }
          set_blending(gl, Blending::over);
          gl.LoadMatrixf(identity.data());
          for (int i = 0; i < 64; ++i) {
            const float depth = -(2.6F + 0.87F) + 1.74F * (static_cast<float>(i) + 0.5F) / 64;
            gl.Begin(GL_QUADS);
            for (const auto& [x, y] : {std::array{-1.2F, -1.2F}, {1.2F, -1.2F}, {1.2F, 1.2F}, {-1.2F, 1.2F}})
              gl.Vertex3f(x, y, depth);
            gl.End();
          }
        };
      }};
}

}  // namespace adversary::slices
