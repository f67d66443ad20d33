// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario change_drag_pumice_glsl_120() {
  return {
      .sentence =
          "Pumice of 40 x 40 x 48 luminance bytes in GLSL 1.20, immediate mode, a dense 1-D table. In frames 8 "
          "to 16 the user drags: the camera turns by 7 degrees a frame and steps are two and a half times as "
          "long, without a correction of opacity; frame 17 is frame 16's view in fine steps, and stays.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {8, 9, 16, 17},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D tex;
uniform sampler1D lut;
uniform vec3 camPos;
uniform float dt;

void main(void)
{
    vec3 p = gl_TexCoord[0].xyz;
    vec3 rd = normalize(p - camPos);
    vec3 far3 = (step(0.0, rd) - p) / rd;
    float tmax = min(min(far3.x, far3.y), far3.z);
    vec3 c = vec3(0.0);
    float T = 1.0;
    for (float t = 0.0; t < tmax; t += dt) {
        vec4 s = texture1D(lut, texture3D(tex, p + t * rd).x);
        c += T * s.a * s.rgb;
        T *= 1.0 - s.a;
    }
    gl_FragColor = vec4(c, 1.0 - T);
}
)");
        const Field pumice = [](float x, float y, float z) {
          const float pores = std::sin(11 * x + 3 * y) * std::sin(13 * y - 2 * z) +
                              std::sin(12 * z + 4 * x + 1) * std::cos(9 * x - 5 * y);
          const float a = x - 0.5F, b = y - 0.45F, c = z - 0.55F;
          return std::clamp(0.55F + 0.3F * pores - 0.8F * (a * a + b * b + c * c), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(60 + 190 * at),
                           static_cast<std::uint8_t>(90 + 80 * std::sin(5 * at)),
                           static_cast<std::uint8_t>(200 - 170 * at),
                           static_cast<std::uint8_t>(std::lround(2 + 48 * at * at))});
        }
        upload_volume(canvas, 0, sampled(40, 40, 48, pumice), {.shown = Shown::luminance});
        upload_table_1d(canvas, 1, table);
        return [&canvas, program](int frame) {
          const float turned = 0.5F * static_cast<float>(std::min(frame, 8)) +
                               7 * static_cast<float>(std::clamp(frame - 8, 0, 8));
          const Camera camera = old_camera(canvas, 0, {.azimuth = 40 + turned, .elevation = 15});
          begin_old_frame(canvas, camera);
          program.use();
          program.set("tex", 0);
          program.set("lut", 1);
          program.set("camPos", camera.eye);
          program.set("dt", frame >= 8 && frame <= 16 ? 0.05F : 0.02F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          canvas.gl.Begin(GL_TRIANGLES);
          for (const Vector& corner : box_triangles()) {
            canvas.gl.TexCoord3f(corner.x, corner.y, corner.z);
            canvas.gl.Vertex3f(corner.x, corner.y, corner.z);
          }
          canvas.gl.End();
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
