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

Scenario handed_array() {
  return {
      .sentence =
          "A sea urchin of 56 x 52 x 60 bytes in GLSL 4.00. An array of three floats goes from the vertex "
          "shader to the fragment shader: how far the vertex lies from each of three planes, which only the "
          "vertex shader knows. Samples beyond any of them are left out. All three miss the box until frame "
          "10, when the second one enters it.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 400 core
layout(location = 0) in vec3 corner;
uniform mat4 clip_from_volume;
uniform vec4 planes[3];

out vec3 entry;
out float distances[3];

void main() {
  entry = corner;
  for (int k = 0; k < 3; ++k) distances[k] = dot(planes[k], vec4(corner, 1.0));
  gl_Position = clip_from_volume * vec4(corner, 1.0);
}
)",
                                  R"(#version 400 core
uniform sampler3D urchin;
uniform sampler2D colours;
uniform vec3 eye;
uniform float spacing;

in vec3 entry;
in float distances[3];
layout(location = 0) out vec4 shown;

// The planes' own; their distances change.
const vec3 normals[3] = vec3[3](vec3(0.0, 1.0, 0.0), vec3(-0.48, -0.6, -0.64), vec3(0.6, 0.0, -0.8));

void main() {
  vec3 along = normalize(entry - eye);
  vec3 walls = (step(0.0, along) - entry) / along;
  int count = int(min(walls.x, min(walls.y, walls.z)) / spacing) + 1;
  float nearer[3];
  for (int k = 0; k < 3; ++k) nearer[k] = dot(normals[k], along);

  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float t = float(i) * spacing;
    bool kept = true;
    for (int k = 0; k < 3; ++k) kept = kept && distances[k] + t * nearer[k] >= 0.0;
    if (!kept) continue;
    vec4 colour = texture(colours, vec2(texture(urchin, entry + t * along).r, 0.5));
    sum.rgb += (1.0 - sum.a) * colour.a * colour.rgb;
    sum.a += (1.0 - sum.a) * colour.a;
  }
  shown = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field urchin = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.48F, c = z - 0.51F;
          const float away = std::sqrt(a * a + b * b + c * c), beside = away + 0.04F;
          const float spines = std::sin(8 * a / beside + 1) * std::cos(7 * b / beside) +
                               std::sin(9 * c / beside + 4 * a / beside);
          const float off = away - 0.31F - 0.06F * spines;
          const float test = std::exp(-170 * off * off);
          const float inside =
              std::exp(-32 * away * away) * (0.6F + 0.4F * std::sin(15 * x + 2) * std::cos(13 * y - 9 * z));
          return std::clamp(0.07F + 0.62F * test + 0.7F * inside + 0.04F * std::sin(8 * z - 7 * x + 3 * y),
                            0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float lime = std::clamp((at - 0.18F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(120 + 120 * std::sin(2.8F * at)),
                           static_cast<std::uint8_t>(60 + 150 * lime * lime),
                           static_cast<std::uint8_t>(170 - 90 * lime),
                           static_cast<std::uint8_t>(std::lround(2 + 4 * at + 36 * lime))});
        }
        upload_volume(canvas, 0, sampled(56, 52, 60, urchin));
        upload_table_2d(canvas, 1, table);
        program.use();
        program.set("urchin", 0);
        program.set("colours", 1);
        program.set("spacing", 0.0165F);
        return [&canvas, program, vertices](int frame) {
          const Camera camera =
              camera_at({.azimuth = 8, .elevation = 32, .distance = 2.4F, .degrees_each_frame = 1.5F}, frame,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          using Plane = std::array<float, 4>;
          const auto beyond = [](Vector normal, float distance) {
            return Plane{normal.x, normal.y, normal.z, -distance};
          };
          // The second one takes the half towards the eye, as its way leads around it.
          const Vector second{-0.48F, -0.6F, -0.64F};
          const std::array<Plane, 3> planes{
              beyond({0, 1, 0}, -0.3F), beyond(second, frame < 10 ? -2.4F : dot(second, {0.5F, 0.48F, 0.51F})),
              beyond({0.6F, 0, -0.8F}, -1.1F)};
          canvas.begin(0.06F, 0.12F, 0.16F);
          program.use();
          program.set("clip_from_volume", camera.clip_from_object());
          program.set("eye", camera.eye);
          canvas.gl.Uniform4fv(program.location("planes"), 3, planes.front().data());
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
