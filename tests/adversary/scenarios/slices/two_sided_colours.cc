// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario two_sided_colours() {
  return {.sentence =
              "The vertex shader of GLSL 1.20 gives slices one colour in front, and another at the back, which "
              "they turn to the eye. From frame 10 on, OpenGL distinguishes them. The camera stands still.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 120
void main() {
  gl_TexCoord[0] = gl_MultiTexCoord0;
  gl_FrontColor = vec4(1.0);
  gl_BackColor = vec4(1.0, 0.2, 0.1, 1.0);
  gl_Position = ftransform();
}
)",
                                      R"(#version 120
uniform sampler3D volume;
void main() {
  float grey = texture3D(volume, gl_TexCoord[0].xyz).r;
  gl_FragColor = gl_Color * vec4(vec3(grey), 0.08 * grey);
}
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, 0);
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volume", 0);
              set_blending(canvas.gl, Blending::over);
              // Whichever way the slices turn, it is the back from one of these frames on.
              canvas.gl.FrontFace(frame < 20 ? GL_CW : GL_CCW);
              if (frame == 10) canvas.gl.Enable(GL_VERTEX_PROGRAM_TWO_SIDE);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
