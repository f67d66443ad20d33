// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
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

Scenario packed_array_of_blocks() {
  return {
      .sentence =
          "A cone of a pine, 52 x 60 x 52 floats, in GLSL 3.30. Two cutting planes lie in an array of uniform "
          "blocks, with a buffer each; samples beyond either are left out. Both miss the box until frame 9, "
          "when the second buffer is rewritten.",
      .expectation = Expectation::either,
      .key_frames = {9},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 a_place;
uniform mat4 u_matrix;

out vec3 v_place;

void main() {
  v_place = a_place;
  gl_Position = u_matrix * vec4(a_place, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D u_cone;
uniform sampler2D u_lut;
uniform vec3 u_eye;
uniform float u_spacing;
layout(std140) uniform Cut {
  vec4 plane;
} cuts[2];

in vec3 v_place;
layout(location = 0) out vec4 f_colour;

void main() {
  vec3 ray = normalize(v_place - u_eye);
  vec3 ends = max(-v_place / ray, (1.0 - v_place) / ray);
  float end = min(min(ends.x, ends.y), ends.z);

  vec4 front = vec4(0.0);
  for (float t = 0.0; t < end; t += u_spacing) {
    vec4 here = vec4(v_place + t * ray, 1.0);
    if (dot(cuts[0].plane, here) < 0.0) continue;
    if (dot(cuts[1].plane, here) < 0.0) continue;
    vec4 entry = texture(u_lut, vec2(texture(u_cone, here.xyz).r, 0.5));
    front.rgb += (1.0 - front.a) * entry.a * entry.rgb;
    front.a += (1.0 - front.a) * entry.a;
  }
  f_colour = front;
}
)");
        const VertexBuffer vertices(canvas);
        const Field cone = [](float x, float y, float z) {
          const float a = x - 0.5F, c = z - 0.5F;
          const float away = std::sqrt(a * a + c * c), around = std::atan2(c, a);
          const float width = 0.16F + 0.27F * std::sin(2.9F * y + 0.2F);
          // Scales along spirals of both senses; towards the axis they are one.
          const float scales = std::sin(5 * around + 14 * y) * std::sin(3 * around - 17 * y + 1) *
                               std::clamp(5 * away, 0.0F, 1.0F);
          const float body = std::clamp(6 - 12 * (away - width + 0.42F), 0.0F, 1.0F);
          const float core = std::exp(-60 * away * away);
          return std::clamp(
              0.05F + body * (0.36F + 0.3F * scales + 0.35F * core) + 0.03F * std::sin(8 * x - 7 * z), 0.0F,
              1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float wood = std::clamp((at - 0.15F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(90 + 150 * wood),
                           static_cast<std::uint8_t>(60 + 140 * at * at),
                           static_cast<std::uint8_t>(50 + 70 * std::sin(6 * at)),
                           static_cast<std::uint8_t>(std::lround(1 + 4 * at + 42 * wood))});
        }
        upload_volume(canvas, 0, sampled(52, 60, 52, cone), {.texel = Texel::float32});
        upload_table_2d(canvas, 1, table);

        const Gl& gl = canvas.gl;
        using Plane = std::array<float, 4>;
        constexpr Plane below{0, 1, 0, 0.6F};
        constexpr Plane beside{0.64F, -0.48F, -0.6F, 2};
        std::array<GLuint, 2> blocks{};
        gl.GenBuffers(2, blocks.data());
        for (GLuint i = 0; i < 2; ++i) {
          gl.BindBuffer(GL_UNIFORM_BUFFER, blocks[i]);
          gl.BufferData(GL_UNIFORM_BUFFER, sizeof(Plane), i == 0 ? below.data() : beside.data(),
                        GL_DYNAMIC_DRAW);
          gl.BindBufferBase(GL_UNIFORM_BUFFER, 3 + i, blocks[i]);
        }
        gl.UniformBlockBinding(program.name(), gl.GetUniformBlockIndex(program.name(), "Cut[0]"), 3);
        gl.UniformBlockBinding(program.name(), gl.GetUniformBlockIndex(program.name(), "Cut[1]"), 4);
        program.use();
        program.set("u_cone", 0);
        program.set("u_lut", 1);
        program.set("u_spacing", 0.0165F);
        return [&canvas, &gl, program, vertices, blocks](int frame) {
          if (frame == 9) {
            const Vector normal{0.64F, -0.48F, -0.6F};
            const Plane through{normal.x, normal.y, normal.z, -dot(normal, {0.5F, 0.48F, 0.5F})};
            gl.BindBuffer(GL_UNIFORM_BUFFER, blocks[1]);
            gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(through), through.data());
          }
          const Camera camera =
              camera_at({.azimuth = 290, .elevation = 26, .distance = 2.35F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.1F, 0.14F, 0.2F);
          program.use();
          program.set("u_matrix", camera.clip_from_object());
          program.set("u_eye", camera.eye);
          set_blending(gl, Blending::premultiplied_over);
          gl.Enable(GL_CULL_FACE);
          gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
