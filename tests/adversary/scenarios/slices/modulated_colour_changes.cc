// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario modulated_colour_changes() {
  return {.sentence = "Fixed function: intensities modulated by a colour of its own for each slice.",
          .expectation = Expectation::either,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::intensity});
            return [&canvas](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              canvas.gl.Enable(GL_TEXTURE_3D);
              canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
              set_blending(canvas.gl, Blending::over);
              float part = 0;
              for (const Polygon& polygon : view_aligned_slices(camera, 64)) {
                canvas.gl.Color4f(part, 0.5F, 1 - part, 0.1F);
                part += 1.0F / 64;
                draw_polygons(canvas.gl, {polygon});
              }
            };
          }};
}

}  // namespace adversary::slices
