// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario state_material_edited() {
  return {.sentence =
              "GLSL 1.20, colours of a table times gl_FrontMaterial.diffuse, which turns from white to orange "
              "at frame 10.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
void main() {
  vec4 colour = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz).r);
  gl_FragColor = colour * gl_FrontMaterial.diffuse;
}
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, soft_colours());
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volume", 0);
              program.set("table", 1);
              const std::array<GLfloat, 4> diffuse{1, frame < 10 ? 1.0F : 0.55F, frame < 10 ? 1.0F : 0.2F, 1};
              if (frame == 0 || frame == 10)
                canvas.gl.Materialfv(GL_FRONT_AND_BACK, GL_DIFFUSE, diffuse.data());
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
