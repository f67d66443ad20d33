// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fixed_function_display_list() {
  return {.sentence = "Fixed function: slices across the nearest axis, compiled into display lists once.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
            const GLuint list = canvas.gl.GenLists(1);
            canvas.gl.NewList(list, GL_COMPILE);
            draw_polygons(canvas.gl, axis_aligned_slices(old_camera(canvas, 0, {.azimuth = 10}), 48));
            canvas.gl.EndList();
            return [&canvas, list](int frame) {
              begin_old_frame(canvas, old_camera(canvas, frame, {.azimuth = 10}));
              canvas.gl.Enable(GL_TEXTURE_3D);
              canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
              set_blending(canvas.gl, Blending::over);
              canvas.gl.CallList(list);
            };
          }};
}

}  // namespace adversary::slices
