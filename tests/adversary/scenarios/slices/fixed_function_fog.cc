// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fixed_function_fog() {
  return {.sentence = "Fixed function with GL_EXP2 fog that fades the slices' colours.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
            return [&canvas](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              canvas.gl.Enable(GL_TEXTURE_3D);
              canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
              constexpr std::array<GLfloat, 4> colour{0.1F, 0.12F, 0.2F, 1};
              canvas.gl.Enable(GL_FOG);
              canvas.gl.Fogi(GL_FOG_MODE, GL_EXP2);
              canvas.gl.Fogf(GL_FOG_DENSITY, 0.3F);
              canvas.gl.Fogfv(GL_FOG_COLOR, colour.data());
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
