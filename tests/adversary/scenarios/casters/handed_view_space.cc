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

Scenario handed_view_space() {
  return {
      .sentence =
          "A ginger root of 60 x 48 x 56 bytes in GLSL 4.50. The vertex shader hands on the place in the "
          "texture, the place in view space and the eye, which it takes from the inverse of the view matrix. "
          "What is near to the eye fades, by the place in view space; as far off as this box ever is, that is "
          "less than half a percent. Nothing changes but the camera: it turns until frame 5, moves nearer "
          "until frame 11, sideways until frame 17, and turns again.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 a_position;

layout(location = 0) uniform mat4 u_projection;
layout(location = 1) uniform mat4 u_view;

layout(location = 0) out vec3 v_texture;
layout(location = 1) out vec3 v_view;
layout(location = 2) flat out vec3 v_eye;

void main() {
  vec4 in_view = u_view * vec4(a_position, 1.0);
  v_texture = a_position;
  v_view = in_view.xyz;
  v_eye = inverse(u_view)[3].xyz;
  gl_Position = u_projection * in_view;
}
)",
                                  R"(#version 450 core
layout(binding = 0) uniform sampler3D u_root;
layout(binding = 1) uniform sampler2D u_table;
layout(location = 2) uniform float u_step;

layout(location = 0) in vec3 v_texture;
layout(location = 1) in vec3 v_view;
layout(location = 2) flat in vec3 v_eye;
layout(location = 0) out vec4 o_colour;

void main() {
  vec3 direction = normalize(v_texture - v_eye);
  vec3 walls = (step(0.0, direction) - v_texture) / direction;
  int count = int(min(walls.x, min(walls.y, walls.z)) / u_step) + 1;

  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float value = texture(u_root, v_texture + float(i) * u_step * direction).r;
    vec4 colour = texture(u_table, vec2(value, 0.5));
    sum.rgb += (1.0 - sum.a) * colour.a * colour.rgb;
    sum.a += (1.0 - sum.a) * colour.a;
  }
  // So that nobody flies into a wall.
  float fade = 1.0 - exp(6.0 * v_view.z);
  o_colour = fade * sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field ginger = [](float x, float y, float z) {
          const auto finger = [x, y, z](Vector from, Vector to, float thickness) {
            const Vector along = to - from, here = Vector{x, y, z} - from;
            const float at = std::clamp(dot(here, along) / dot(along, along), 0.0F, 1.0F);
            const Vector off = here - at * along;
            return std::exp(-dot(off, off) / (thickness * thickness));
          };
          const float sum = 0.6F * finger({0.2F, 0.42F, 0.5F}, {0.8F, 0.5F, 0.46F}, 0.13F) +
                            0.5F * finger({0.42F, 0.45F, 0.5F}, {0.34F, 0.82F, 0.66F}, 0.11F) +
                            0.55F * finger({0.62F, 0.5F, 0.48F}, {0.74F, 0.8F, 0.26F}, 0.1F) +
                            0.5F * finger({0.55F, 0.45F, 0.5F}, {0.6F, 0.22F, 0.82F}, 0.11F);
          const float fibres = std::sin(16 * x + 4 * y + 1) * std::cos(15 * z - 6 * x) +
                               0.6F * std::sin(18 * y + 2.5F * std::sin(9 * x));
          return std::clamp(0.07F + sum * (0.8F + 0.25F * fibres) + 0.03F * std::sin(8 * x + 7 * y - 9 * z),
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float flesh = std::clamp((at - 0.16F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(130 + 120 * flesh),
                           static_cast<std::uint8_t>(90 + 130 * flesh * flesh),
                           static_cast<std::uint8_t>(130 - 80 * std::sin(3.1F * at)),
                           static_cast<std::uint8_t>(std::lround(2 + 4 * at + 36 * flesh))});
        }
        upload_volume(canvas, 0, sampled(60, 48, 56, ginger));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("u_step", 0.0165F);
        return [&canvas, program, vertices](int frame) {
          const int turned = std::min(frame, 5) + std::max(frame - 17, 0);
          const auto nearer = static_cast<float>(std::clamp(frame - 5, 0, 6));
          const auto aside = static_cast<float>(std::clamp(frame - 11, 0, 6));
          const Camera camera =
              camera_at({.azimuth = 15,
                         .elevation = 24,
                         .distance = 2.6F - 0.08F * nearer,
                         .degrees_each_frame = 1.5F,
                         .sideways = 0.03F * aside},
                        turned, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.12F, 0.1F, 0.17F);
          program.use();
          program.set("u_projection", camera.projection);
          program.set("u_view", camera.view);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
