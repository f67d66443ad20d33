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

Scenario packed_planes_array() {
  return {.sentence =
              "A geode of 60 x 52 x 48 bytes in GLSL 4.20. Matrix, eye and four planes in an array lie in one "
              "uniform block, rewritten in every frame; samples behind any plane are left out. The first plane "
              "stands before the eye, moves with it and cuts nothing; the third misses the box until frame 13, "
              "and cuts off a third of it from then on.",
          .expectation = Expectation::either,
          .key_frames = {13},
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 vertex;
layout(std140, binding = 1) uniform View {
  mat4 clip;
  vec4 eye;
  vec4 planes[4];
};

out vec3 surface;

void main() {
  surface = vertex;
  gl_Position = clip * vec4(vertex, 1.0);
}
)",
                                      R"(#version 420 core
layout(std140, binding = 1) uniform View {
  mat4 clip;
  vec4 eye;
  vec4 planes[4];
};
layout(binding = 0) uniform sampler3D minerals;
layout(binding = 1) uniform sampler2D shades;

in vec3 surface;
layout(location = 0) out vec4 pixel;

const float spacing = 0.017;

bool hidden(vec3 p) {
  for (int k = 0; k < 4; ++k)
    if (dot(planes[k], vec4(p, 1.0)) < 0.0) return true;
  return false;
}

void main() {
  vec3 d = normalize(surface - eye.xyz);
  vec3 walls = (step(vec3(0.0), d) - surface) / d;
  int count = int(min(walls.x, min(walls.y, walls.z)) / spacing) + 1;

  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    vec3 p = surface + float(i) * spacing * d;
    if (hidden(p)) continue;
    vec4 shade = texture(shades, vec2(texture(minerals, p).r, 0.5));
    sum += (1.0 - sum.a) * vec4(shade.a * shade.rgb, shade.a);
  }
  pixel = sum;
}
)");
            const VertexBuffer vertices(canvas);
            const Field geode = [](float x, float y, float z) {
              const float a = x - 0.5F, b = y - 0.5F, c = z - 0.52F;
              const float away = std::sqrt(a * a + 1.1F * b * b + c * c);
              const float uneven = away + 0.03F * std::sin(8 * x - 5 * y) + 0.025F * std::cos(9 * z + 4 * x);
              const float rind = std::exp(-260 * (uneven - 0.39F) * (uneven - 0.39F));
              const float crystals =
                  std::exp(-90 * (uneven - 0.24F) * (uneven - 0.24F)) *
                  (0.55F + 0.45F * std::sin(17 * x + 2) * std::cos(16 * y) * std::sin(15 * z + 1));
              return std::clamp(0.07F + 0.45F * rind + 0.85F * crystals + 0.04F * std::sin(9 * y - 6 * z), 0.0F,
                                1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float stone = std::clamp((at - 0.16F) / 0.3F, 0.0F, 1.0F);
              const float glass = std::clamp((at - 0.4F) / 0.35F, 0.0F, 1.0F);
              table.push_back({static_cast<std::uint8_t>(190 - 80 * glass),
                               static_cast<std::uint8_t>(150 - 90 * std::sin(2.6F * glass)),
                               static_cast<std::uint8_t>(80 + 165 * glass),
                               static_cast<std::uint8_t>(std::lround(2 + 20 * stone + 26 * glass))});
            }
            upload_volume(canvas, 0, sampled(60, 52, 48, geode));
            upload_table_2d(canvas, 1, table);
            using Plane = std::array<float, 4>;
            struct View {
              Matrix clip;
              Plane eye;
              std::array<Plane, 4> planes;
            };
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, sizeof(View), nullptr, GL_DYNAMIC_DRAW);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 1, block);
            return [&canvas, program, vertices, block](int frame) {
              const Camera camera =
                  camera_at({.azimuth = 12, .elevation = 16, .distance = 2.35F, .degrees_each_frame = 1.5F},
                            frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              const auto beyond = [](Vector normal, float distance) {
                return Plane{normal.x, normal.y, normal.z, -distance};
              };
              const View view{.clip = camera.clip_from_object(),
                              .eye = {camera.eye.x, camera.eye.y, camera.eye.z, 1},
                              .planes = {beyond(camera.forward, dot(camera.forward, camera.eye) + 0.4F),
                                         beyond({0, 1, 0}, -0.5F),
                                         // From the edge towards the eye, whose distance is -1.4.
                                         beyond({-0.6F, 0, -0.8F}, frame < 13 ? -2.2F : -0.83F),
                                         beyond({-1, 0, 0}, -1.5F)}};
              canvas.gl.BindBuffer(GL_UNIFORM_BUFFER, block);
              canvas.gl.BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(view), &view);
              canvas.begin(0.1F, 0.12F, 0.1F);
              program.use();
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
