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

namespace adversary::casters {

Scenario packed_distance() {
  return {
      .sentence =
          "A cabbage of 56 x 52 x 56 bytes in GLSL 3.30. One vec4 goes from the vertex shader to the fragment "
          "shader: where the ray enters, and in w how far that is from a cutting plane, of an attribute in "
          "millimetres. Samples beyond the plane are left out. Nothing is cut until frame 11, when other "
          "distances are uploaded.",
      .expectation = Expectation::either,
      .key_frames = {11},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 330 core
layout(location = 0) in vec3 corner;
layout(location = 1) in float millimetres;  // from the plane
uniform mat4 mvp;

out vec4 entry_and_distance;

void main() {
  entry_and_distance = vec4(corner, millimetres / 120.0);
  gl_Position = mvp * vec4(corner, 1.0);
}
)",
                                  R"(#version 330 core
uniform sampler3D leaves;
uniform sampler2D colours;
uniform vec3 eye;
uniform float spacing;

in vec4 entry_and_distance;
layout(location = 0) out vec4 shown;

const vec3 plane_normal = vec3(-0.48, -0.64, -0.6);

void main() {
  vec3 entry = entry_and_distance.xyz;
  vec3 along = normalize(entry - eye);
  vec3 walls = (step(0.0, along) - entry) / along;
  int count = int(min(walls.x, min(walls.y, walls.z)) / spacing) + 1;
  float nearer = dot(plane_normal, along);

  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float t = float(i) * spacing;
    if (entry_and_distance.w + t * nearer < 0.0) continue;
    vec4 colour = texture(colours, vec2(texture(leaves, entry + t * along).r, 0.5));
    sum.rgb += (1.0 - sum.a) * colour.a * colour.rgb;
    sum.a += (1.0 - sum.a) * colour.a;
  }
  shown = sum;
}
)");
        const Field cabbage = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.47F, c = z - 0.5F;
          const float away = std::sqrt(a * a + 0.9F * b * b + c * c) +
                             0.03F * std::sin(7 * x + 5 * z) * std::cos(6 * y - 4 * x + 1);
          const float leaves = 0.5F + 0.5F * std::sin(36 * away + 1.2F * std::sin(5 * y + 3 * z));
          const float body = std::clamp(5.6F - 11 * away, 0.0F, 1.0F);
          return std::clamp(0.06F + body * (0.2F + 0.6F * leaves) + 0.04F * std::cos(8 * z - 6 * y), 0.0F,
                            1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float leaf = std::clamp((at - 0.2F) / 0.6F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(40 + 190 * leaf * leaf),
                           static_cast<std::uint8_t>(120 + 110 * leaf),
                           static_cast<std::uint8_t>(110 - 70 * std::sin(3 * at)),
                           static_cast<std::uint8_t>(std::lround(2 + 4 * at + 36 * leaf))});
        }
        upload_volume(canvas, 0, sampled(56, 52, 56, cabbage));
        upload_table_2d(canvas, 1, table);

        const Gl& gl = canvas.gl;
        const std::vector<Vector> corners = box_triangles();
        const Vector normal{-0.48F, -0.64F, -0.6F};
        const auto upload_distances = [&gl, corners, normal](GLuint buffer, float plane) {
          std::vector<float> millimetres;
          for (const Vector corner : corners) millimetres.push_back(120 * (dot(normal, corner) - plane));
          gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
          gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(millimetres.size() * sizeof(float)),
                        millimetres.data(), GL_STATIC_DRAW);
        };
        GLuint array = 0;
        std::array<GLuint, 2> buffers{};  // places, distances
        gl.GenVertexArrays(1, &array);
        gl.GenBuffers(2, buffers.data());
        gl.BindVertexArray(array);
        gl.BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
        gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(Vector)), corners.data(),
                      GL_STATIC_DRAW);
        gl.EnableVertexAttribArray(0);
        gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vector), nullptr);
        upload_distances(buffers[1], -2.5F);
        gl.EnableVertexAttribArray(1);
        gl.VertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(float), nullptr);

        program.use();
        program.set("leaves", 0);
        program.set("colours", 1);
        program.set("spacing", 0.0165F);
        return [&canvas, &gl, program, array, buffers, upload_distances, normal,
                count = static_cast<GLsizei>(corners.size())](int frame) {
          // The nearer half, as the eye's way leads around it.
          if (frame == 11) upload_distances(buffers[1], dot(normal, {0.5F, 0.5F, 0.5F}));
          const Camera camera =
              camera_at({.azimuth = 18, .elevation = 34, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.14F, 0.08F, 0.1F);
          program.use();
          program.set("mvp", camera.clip_from_object());
          program.set("eye", camera.eye);
          set_blending(gl, Blending::premultiplied_over);
          gl.Enable(GL_CULL_FACE);
          gl.CullFace(GL_BACK);
          gl.BindVertexArray(array);
          gl.DrawArrays(GL_TRIANGLES, 0, count);
          gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
