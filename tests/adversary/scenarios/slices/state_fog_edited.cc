// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario state_fog_edited() {
  return {.sentence =
              "GLSL 1.20 mixes gl_Fog.color into every sample, by gl_Fog.density. The colour turns at frame "
              "10, the density grows at frame 20. GL_FOG stays disabled.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
void main() {
  vec4 colour = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz).r);
  gl_FragColor = vec4(mix(colour.rgb, gl_Fog.color.rgb, gl_Fog.density), colour.a);
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
              const std::array<GLfloat, 4> fog{frame < 10 ? 0.1F : 0.9F, 0.3F, frame < 10 ? 0.8F : 0.1F, 1};
              if (frame == 0 || frame == 10) canvas.gl.Fogfv(GL_FOG_COLOR, fog.data());
              if (frame == 0 || frame == 20) canvas.gl.Fogf(GL_FOG_DENSITY, frame < 20 ? 0.4F : 0.8F);
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
