// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario count_advance_first() {
  return {
      .sentence =
          "Pillows of 32 x 40 x 48 bytes in GLSL 1.30: a loop that goes a step ahead before it "
          "samples, as long as what it had travelled is shorter than the ray; the colour is not "
          "premultiplied when it leaves the shader.",
      .expectation = Expectation::must_be_substituted,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 130

in vec3 position;

uniform mat4 u_mvp;
uniform vec3 u_eye;

out vec3 v_ray;

void main()
{
  v_ray = position - u_eye;
  gl_Position = u_mvp * vec4(position, 1.0);
}
)",
                                  R"(#version 130

in vec3 v_ray;

uniform vec3 u_eye;
uniform float u_step;
uniform sampler3D u_data;
uniform sampler2D u_lut;

out vec4 o_color;

void main()
{
  vec3 dir = normalize(v_ray);
  vec3 first = (vec3(0.0) - u_eye) / dir;
  vec3 second = (vec3(1.0) - u_eye) / dir;
  vec3 lower = min(first, second);
  vec3 upper = max(first, second);
  float start = max(max(lower.x, lower.y), lower.z);
  float stop = min(min(upper.x, upper.y), upper.z);
  start = max(start, 0.0);

  float ray_length = stop - start;
  float travelled = 0.0;
  vec3 p = u_eye + start * dir;
  vec4 acc = vec4(0.0);
  while (travelled < ray_length)
  {
    p += dir * u_step;
    travelled += u_step;
    float intensity = texture(u_data, p).r;
    // Table entries are looked up at their middles.
    vec4 c = texture(u_lut, vec2((intensity * 127.0 + 0.5) / 128.0, 0.5));
    acc.rgb += (1.0 - acc.a) * c.a * c.rgb;
    acc.a += (1.0 - acc.a) * c.a;
  }
  o_color = acc.a > 0.0 ? vec4(acc.rgb / acc.a, acc.a) : vec4(0.0);
}
)");
        const VertexBuffer vertices(canvas);
        const Field pillows = [](float x, float y, float z) {
          const float seam = std::sin(5 * x + 0.4F) * std::sin(6 * z + 0.9F);
          const float thickness = 0.18F + 0.16F * seam * seam;
          const float away = std::abs(y - 0.48F - 0.1F * x);
          return std::clamp(0.5F + 1.4F * (thickness - away) + 0.07F * std::sin(11 * z - 6 * y), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 128; ++i) {
          const float at = static_cast<float>(i) / 127;
          const float cloth = std::exp(-std::pow((at - 0.62F) / 0.2F, 2.0F));
          table.push_back({static_cast<std::uint8_t>(120 + 110 * cloth),
                           static_cast<std::uint8_t>(180 * at + 40),
                           static_cast<std::uint8_t>(210 - 140 * cloth),
                           static_cast<std::uint8_t>(std::lround(40 * cloth + 6 * at))});
        }
        upload_volume(canvas, 0, sampled(32, 40, 48, pillows));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("u_data", 0);
        program.set("u_lut", 1);
        program.set("u_step", 0.02F);
        return [&canvas, program, vertices](int frame) {
          const Orbit orbit{.azimuth = 20, .elevation = 36, .distance = 2.6F, .degrees_each_frame = 1.3F};
          const Camera camera =
              camera_at(orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.22F, 0.24F, 0.28F);
          program.use();
          program.set("u_mvp", camera.clip_from_object());
          program.set("u_eye", camera.eye);
          set_blending(canvas.gl, Blending::over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_FRONT);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
