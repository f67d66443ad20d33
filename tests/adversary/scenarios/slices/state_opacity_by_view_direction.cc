// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario state_opacity_by_view_direction() {
  return {.sentence =
              "GLSL 1.20 corrects opacity by the viewing direction: it takes alpha times the absolute value of "
              "an element of gl_ModelViewMatrix. The camera turns in every frame.",
          .expectation = Expectation::either,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
void main() {
  gl_FragColor = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz).r);
  gl_FragColor.a *= abs(gl_ModelViewMatrix[2].z);
}
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, soft_colours());
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, 3 * frame);
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volume", 0);
              program.set("table", 1);
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
