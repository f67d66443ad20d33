// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario glsl_120_window() {
  return {.sentence = "GLSL 1.20, grey levels by a window of values whose ends are uniforms that stay.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volume;
uniform float low, high;
void main() {
  float grey = clamp((texture3D(volume, gl_TexCoord[0].xyz).r - low) / (high - low), 0.0, 1.0);
  gl_FragColor = vec4(vec3(grey), 0.08 * grey);
}
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volume", 0);
              program.set("low", 0.2F);
              program.set("high", 0.8F);
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
