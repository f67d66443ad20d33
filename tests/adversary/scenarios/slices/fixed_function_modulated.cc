// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fixed_function_modulated() {
  return {.sentence = "Fixed function: intensities modulated by one colour, with an alpha test.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::intensity});
            return [&canvas](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              canvas.gl.Enable(GL_TEXTURE_3D);
              canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
              canvas.gl.Color4f(1, 0.8F, 0.5F, 0.12F);
              canvas.gl.Enable(GL_ALPHA_TEST);
              canvas.gl.AlphaFunc(GL_GREATER, 0.02F);
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
