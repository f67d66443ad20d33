// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario glsl_110_table_1d() {
  return {.sentence = "GLSL 1.10 in immediate mode, a table in a 1-D texture.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, old_vertex_shader, R"(
uniform sampler3D volume;
uniform sampler1D table;
void main() { gl_FragColor = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz).r); }
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, soft_colours());
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, frame);
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
