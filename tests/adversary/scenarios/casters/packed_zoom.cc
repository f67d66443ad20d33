// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"
#include "tests/adversary/vertex_buffer.h"

namespace adversary::casters {

Scenario packed_zoom() {
  return {
      .sentence =
          "A snail's shell of 60 x 44 x 60 bytes in GLSL 4.50. Projection, view and model are three matrices "
          "of the vertex shader, which gives where rays enter and where they go. The camera turns until "
          "frame 5 and zooms in from frame 6 on, the model is rotated in frames 12 to 17, and the camera "
          "turns again.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {12, 13, 14, 15, 16, 17},
      .most_compared = 6,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 450 core
layout(location = 0) in vec3 a_position;

uniform mat4 u_projection;
uniform mat4 u_view;
uniform mat4 u_model;

layout(location = 0) out vec3 v_entry;
layout(location = 1) out vec3 v_direction;

void main()
{
    mat4 view_from_model = u_view * u_model;
    vec3 eye = inverse(view_from_model)[3].xyz;
    v_entry = a_position;
    v_direction = a_position - eye;
    gl_Position = u_projection * (view_from_model * vec4(a_position, 1.0));
}
)",
                                  R"(#version 450 core
layout(binding = 0) uniform sampler3D u_shell;
layout(binding = 1) uniform sampler2D u_table;
uniform float u_step;

layout(location = 0) in vec3 v_entry;
layout(location = 1) in vec3 v_direction;
layout(location = 0) out vec4 o_colour;

void main()
{
    vec3 direction = normalize(v_direction);
    vec3 ends = (step(0.0, direction) - v_entry) / direction;
    int count = int(min(ends.x, min(ends.y, ends.z)) / u_step) + 1;

    vec4 sum = vec4(0.0);
    for (int i = 0; i < count; ++i)
    {
        float value = texture(u_shell, v_entry + float(i) * u_step * direction).r;
        vec4 colour = texture(u_table, vec2(value, 0.5));
        sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
    }
    o_colour = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field shell = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.5F, c = z - 0.48F;
          const float away = std::sqrt(a * a + c * c);
          // Two and a half turns from the middle to the rim.
          const float turns = std::atan2(c, a) + 8 * std::log(away + 0.12F);
          const float coil = 0.5F + 0.5F * std::cos(turns);
          const float lift = b - 0.5F * (0.3F - away);
          const float body = std::exp(-26 * lift * lift) * std::clamp(5.4F - 11 * away, 0.0F, 1.0F);
          const float growth = 0.1F * std::sin(4 * turns + 9 * y) * std::clamp(6 * away, 0.0F, 1.0F);
          return std::clamp(
              0.06F + body * (0.15F + 0.6F * coil + growth) + 0.04F * std::sin(8 * x + 6 * z) * std::cos(9 * y),
              0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float lime = std::clamp((at - 0.15F) / 0.55F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(130 + 120 * lime),
                           static_cast<std::uint8_t>(100 + 100 * lime * lime),
                           static_cast<std::uint8_t>(150 - 80 * std::sin(4 * at)),
                           static_cast<std::uint8_t>(std::lround(2 + 5 * at + 34 * lime))});
        }
        upload_volume(canvas, 0, sampled(60, 44, 60, shell));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("u_step", 0.017F);
        return [&canvas, program, vertices](int frame) {
          const int turned = std::min(frame, 5) + std::max(frame - 17, 0);
          const Camera camera =
              camera_at({.azimuth = 130, .elevation = 38, .distance = 2.4F, .degrees_each_frame = 1.5F}, turned,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          const float zoom = 1 + 0.07F * static_cast<float>(std::clamp(frame - 5, 0, 6));
          Matrix projection = camera.projection;
          projection[0] *= zoom;
          projection[5] *= zoom;
          const float angle =
              2.5F * static_cast<float>(std::clamp(frame - 11, 0, 6)) * std::numbers::pi_v<float> / 180;
          const float cosine = std::cos(angle), sine = std::sin(angle);
          // About the axis of x, through the box's centre.
          const Matrix model{1,
                             0,
                             0,
                             0,
                             0,
                             cosine,
                             sine,
                             0,
                             0,
                             -sine,
                             cosine,
                             0,
                             0,
                             0.5F - 0.5F * (cosine - sine),
                             0.5F - 0.5F * (cosine + sine),
                             1};
          canvas.begin(0.07F, 0.13F, 0.12F);
          program.use();
          program.set("u_projection", projection);
          program.set("u_view", camera.view);
          program.set("u_model", model);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
