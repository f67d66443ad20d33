// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario texture_matrix() {
  return {
      .sentence = "Fixed function: the texture matrix turns the volume inside its box, further in every frame.",
      .expectation = Expectation::either,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
        return [&canvas](int frame) {
          const Camera camera = old_camera(canvas, 0);
          begin_old_frame(canvas, camera);
          Matrix turned = identity;
          const float angle = 0.03F * static_cast<float>(frame);
          turned[0] = turned[5] = std::cos(angle);
          turned[1] = std::sin(angle);
          turned[4] = -turned[1];
          canvas.gl.MatrixMode(GL_TEXTURE);
          canvas.gl.LoadMatrixf(turned.data());
          canvas.gl.MatrixMode(GL_MODELVIEW);
          canvas.gl.Enable(GL_TEXTURE_3D);
          canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
          set_blending(canvas.gl, Blending::over);
          draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
        };
      }};
}

}  // namespace adversary::slices
