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

Scenario vertex_attribute_cut() {
  return {.sentence =
              "Three rings of 60 x 48 x 48 floats in GLSL 4.10. How far each of the box's vertices lies from a "
              "cutting plane is an attribute in a vertex buffer of its own; samples beyond the plane are left "
              "out, by the attribute and the ray's direction. Nothing is cut until frame 10, when other "
              "distances are uploaded.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 410 core
layout(location = 0) in vec3 in_place;
layout(location = 1) in float in_from_plane;
uniform mat4 clip_from_volume;

out vec3 place;
out float from_plane;

void main() {
  place = in_place;
  from_plane = in_from_plane;
  gl_Position = clip_from_volume * vec4(in_place, 1.0);
}
)",
                                      R"(#version 410 core
uniform sampler3D rings;
uniform sampler2D palette;
uniform vec3 eye;
uniform vec3 plane_normal;  // does not change
uniform float spacing;

in vec3 place;
in float from_plane;
layout(location = 0) out vec4 shown;

void main() {
  vec3 along = normalize(place - eye);
  float nearer = dot(plane_normal, along);
  vec3 ends = (step(0.0, along) - place) / along;
  int count = int(min(ends.x, min(ends.y, ends.z)) / spacing) + 1;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float t = float(i) * spacing;
    if (from_plane + t * nearer < 0.0) continue;
    vec4 colour = texture(palette, vec2(texture(rings, place + t * along).r, 0.5));
    sum.rgb += (1.0 - sum.a) * colour.a * colour.rgb;
    sum.a += (1.0 - sum.a) * colour.a;
  }
  shown = sum;
}
)");
            const Field rings = [](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.5F, c = z - 0.5F;
              const auto ring = [](float u, float v, float w, float radius) {
                const float off = std::sqrt(u * u + v * v) - radius;
                return std::exp(-75 * (off * off + w * w));
              };
              const float sum = 0.75F * ring(a, b + 0.04F, c - 0.05F, 0.34F) +
                                0.65F * ring(b, c, a + 0.06F, 0.3F) +
                                0.85F * ring(c + 0.03F, a - 0.03F, b - 0.07F, 0.25F);
              return std::clamp(0.1F + sum + 0.06F * std::sin(9 * x - 7 * y + 8 * z), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float metal = std::clamp((at - 0.2F) / 0.5F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(70 + 180 * metal),
                               static_cast<std::uint8_t>(210 - 110 * at),
                               static_cast<std::uint8_t>(190 - 130 * std::sin(2.5F * at)),
                               static_cast<std::uint8_t>(std::lround(3 + 4 * at + 32 * metal))});
            }
            upload_volume(canvas, 0, sampled(60, 48, 48, rings), {.texel = Texel::float32});
            upload_table_2d(canvas, 1, table);

            const Gl& gl = canvas.gl;
            const std::vector<Vector> corners = box_triangles();
            const Vector normal = normalized({-0.45F, -0.75F, -0.5F});
            const auto from_plane = [corners, normal](float distance) {
              std::vector<float> distances;
              for (const Vector corner : corners) distances.push_back(dot(normal, corner) - distance);
              return distances;
            };
            const std::vector<float> uncut = from_plane(-2);
            GLuint array = 0;
            std::array<GLuint, 2> buffers{};  // places, distances
            gl.GenVertexArrays(1, &array);
            gl.GenBuffers(2, buffers.data());
            gl.BindVertexArray(array);
            gl.BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
            gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(Vector)),
                          corners.data(), GL_STATIC_DRAW);
            gl.EnableVertexAttribArray(0);
            gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vector), nullptr);
            gl.BindBuffer(GL_ARRAY_BUFFER, buffers[1]);
            gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(uncut.size() * sizeof(float)), uncut.data(),
                          GL_STATIC_DRAW);
            gl.EnableVertexAttribArray(1);
            gl.VertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(float), nullptr);

            program.use();
            program.set("rings", 0);
            program.set("palette", 1);
            program.set("plane_normal", normal);
            program.set("spacing", 0.0165F);
            return [&canvas, &gl, program, array, buffers, from_plane, normal,
                    count = static_cast<GLsizei>(corners.size())](int frame) {
              if (frame == 10) {
                const std::vector<float> cut = from_plane(dot(normal, {0.5F, 0.5F, 0.5F}));
                gl.BindBuffer(GL_ARRAY_BUFFER, buffers[1]);
                gl.BufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(cut.size() * sizeof(float)),
                                 cut.data());
              }
              const Camera camera =
                  camera_at({.azimuth = 15, .elevation = 30, .distance = 2.4F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.12F, 0.1F, 0.06F);
              program.use();
              program.set("clip_from_volume", camera.clip_from_object());
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
