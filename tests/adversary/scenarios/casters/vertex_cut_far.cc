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

Scenario vertex_cut_far() {
  return {
      .sentence =
          "A cabbage of 52 x 48 x 56 bytes in GLSL 3.30. Only the vertex shader knows a uniform that says how "
          "far rays go, at the box's bottom and at its top; the fragment shader gets it as a float that it "
          "ends its loop by. It is farther than any ray until frame 12, and much nearer then.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 a_vertex;
uniform mat4 u_clip_from_box;
uniform vec2 u_reach;  // at the bottom, at the top

out vec3 v_vertex;
out float v_reach;

void main() {
  v_vertex = a_vertex;
  v_reach = mix(u_reach.x, u_reach.y, a_vertex.y);
  gl_Position = u_clip_from_box * vec4(a_vertex, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D u_volume;
uniform sampler2D u_table;
uniform vec3 u_eye;
uniform float u_step;

in vec3 v_vertex;
in float v_reach;
out vec4 o_colour;

void main() {
  vec3 dir = normalize(v_vertex - u_eye);
  vec3 ends = max(-v_vertex / dir, (1.0 - v_vertex) / dir);
  float last = min(min(ends.x, ends.y), min(ends.z, v_reach));

  vec4 sum = vec4(0.0);
  for (float t = 0.5 * u_step; t < last; t += u_step) {
    float value = texture(u_volume, v_vertex + t * dir).r;
    vec4 leaf = texture(u_table, vec2(value, 0.5));
    sum += (1.0 - sum.a) * vec4(leaf.rgb * leaf.a, leaf.a);
  }
  o_colour = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cabbage = [](float x, float y, float z) {
          const float a = x - 0.48F, b = y - 0.5F, c = z - 0.53F;
          const float away = std::sqrt(a * a + 1.15F * b * b + c * c);
          const float leaf = away + 0.045F * std::sin(8 * x + 2) * std::cos(7 * y - 5 * z);
          const float inside = std::clamp(4.4F - 7.5F * away, 0.0F, 1.0F);
          return std::clamp(0.08F + inside * (0.42F + 0.38F * std::sin(30 * leaf + 1)) + 0.06F * x, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float leaf = std::clamp((at - 0.3F) / 0.45F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(90 + 150 * leaf * leaf),
                           static_cast<std::uint8_t>(120 + 120 * at),
                           static_cast<std::uint8_t>(150 - 90 * leaf),
                           static_cast<std::uint8_t>(std::lround(2 * at + 20 * leaf * leaf))});
        }
        upload_volume(canvas, 0, sampled(52, 48, 56, cabbage));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("u_volume", 0);
        program.set("u_table", 1);
        program.set("u_step", 0.016F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 25, .elevation = 22, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.08F, 0.06F, 0.12F);
          program.use();
          program.set("u_clip_from_box", camera.clip_from_object());
          program.set("u_eye", camera.eye);
          canvas.gl.Uniform2f(program.location("u_reach"), frame < 12 ? 2.0F : 0.65F,
                              frame < 12 ? 2.0F : 0.25F);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
