// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario ends_quartz_glsl_120() {
  return {.sentence =
              "Quartz of 40 x 48 x 32 luminance bytes in GLSL 1.20, immediate mode, under a dense 1-D table: "
              "most rays end, after a sample is added, where alpha >= 0.95.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D quartz;
uniform sampler1D transferFunction;
uniform float stepSize;

void main()
{
  vec3 pos = gl_TexCoord[0].xyz;
  vec3 camera = (gl_ModelViewMatrixInverse * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
  vec3 dir = normalize(pos - camera);
  vec3 delta = dir * stepSize;

  vec4 col_acc = vec4(0.0);
  for (int i = 0; i < 150; i++)
  {
    vec4 c = texture1D(transferFunction, texture3D(quartz, pos).r);
    col_acc.rgb += (1.0 - col_acc.a) * c.a * c.rgb;
    col_acc.a += (1.0 - col_acc.a) * c.a;
    if (col_acc.a >= 0.95)
      break;

    pos += delta;
    if (pos.x < 0.0 || pos.y < 0.0 || pos.z < 0.0 || pos.x > 1.0 || pos.y > 1.0 || pos.z > 1.0)
      break;
  }
  gl_FragColor = col_acc;
}
)");
            const Field quartz = [](float x, float y, float z) {
              const float veins = std::sin(9 * x + 4 * y + 2 * std::sin(7 * z)) +
                                  0.6F * std::cos(12 * y - 6 * z + 1) + 0.4F * std::sin(15 * z * x + 2);
              return std::clamp(0.5F + 0.24F * veins, 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(70 + 180 * at),
                               static_cast<std::uint8_t>(120 + 100 * std::sin(7 * at)),
                               static_cast<std::uint8_t>(230 - 190 * at * at),
                               static_cast<std::uint8_t>(std::lround(8 + 70 * at * at))});
            }
            upload_volume(canvas, 0, sampled(40, 48, 32, quartz), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, table);
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(
                  canvas, frame, {.azimuth = 215, .elevation = 26, .distance = 2.5F, .degrees_each_frame = 3});
              begin_old_frame(canvas, camera);
              program.use();
              program.set("quartz", 0);
              program.set("transferFunction", 1);
              program.set("stepSize", 1.0F / 64);
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
