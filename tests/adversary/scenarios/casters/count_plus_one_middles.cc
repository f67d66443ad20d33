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

Scenario count_plus_one_middles() {
  return {.sentence =
              "A ravine of 48 x 36 x 28 floats in GLSL 4.00, scaled by a model matrix, the eye by the "
              "inverse of model and view: one sample more than whole steps fit into the ray, each in the "
              "middle of its step.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const GlslProgram program(canvas, R"(#version 400 core

layout(location = 0) in vec3 vertex;

uniform mat4 M;
uniform mat4 V;
uniform mat4 P;

out vec3 boxPosition;
flat out vec3 eyeInBox;

void main()
{
  mat4 viewFromBox = V * M;
  boxPosition = vertex;
  eyeInBox = (inverse(viewFromBox) * vec4(0.0, 0.0, 0.0, 1.0)).xyz;
  gl_Position = P * viewFromBox * vec4(vertex, 1.0);
}
)",
                                      R"(#version 400 core

uniform sampler3D ravine;
uniform sampler1D palette;
uniform float samplingDistance;

in vec3 boxPosition;
flat in vec3 eyeInBox;

layout(location = 0) out vec4 fragColor;

void main()
{
  vec3 direction = normalize(boxPosition - eyeInBox);
  vec3 toLow = (0.0 - eyeInBox) / direction;
  vec3 toHigh = (1.0 - eyeInBox) / direction;
  vec3 entries = min(toLow, toHigh);
  vec3 exits = max(toLow, toHigh);
  float entry = max(max(entries.x, entries.y), max(entries.z, 0.0));
  float exit = min(min(exits.x, exits.y), exits.z);
  if (exit <= entry) {
    fragColor = vec4(0.0);
    return;
  }

  int total = int((exit - entry) / samplingDistance) + 1;
  vec4 composed = vec4(0.0);
  for (int i = 0; i < total; ++i) {
    float depth = entry + (float(i) + 0.5) * samplingDistance;
    float value = texture(ravine, eyeInBox + depth * direction).r;
    vec4 entryOfPalette = texture(palette, value);
    float share = entryOfPalette.a * (1.0 - composed.a);
    composed += share * vec4(entryOfPalette.rgb, 1.0);
  }
  fragColor = composed;
}
)");
            const VertexBuffer vertices(canvas);
            const Field ravine = [](float x, float y, float z) {
              const float bed = 0.5F + 0.18F * std::sin(6 * z + 1);
              const float wall = std::abs(x - bed) + 0.05F * std::sin(15 * z + 8 * y);
              return std::clamp(0.35F + 1.1F * wall - 0.5F * y + 0.1F * std::cos(9 * x - 5 * y), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              const float moss = std::exp(-std::pow((at - 0.35F) / 0.15F, 2.0F));
              table.push_back({static_cast<std::uint8_t>(200 - 110 * moss),
                               static_cast<std::uint8_t>(110 + 110 * moss),
                               static_cast<std::uint8_t>(60 + 120 * at),
                               static_cast<std::uint8_t>(std::lround(1 + 24 * moss + 30 * at * at))});
            }
            upload_volume(canvas, 0, sampled(48, 36, 28, ravine), {.texel = Texel::float32});
            upload_table_1d(canvas, 1, table);
            program.use();
            program.set("ravine", 0);
            program.set("palette", 1);
            program.set("samplingDistance", 0.021F);
            // About the centre of the box.
            program.set("M", Matrix{1.1F, 0, 0, 0, 0, 0.9F, 0, 0, 0, 0, 0.8F, 0, -0.05F, 0.05F, 0.1F, 1});
            return [&canvas, program, vertices](int frame) {
              const Orbit orbit{.azimuth = 285, .elevation = 33, .distance = 2.5F, .degrees_each_frame = 1.1F};
              const Camera camera = camera_at(
                  orbit, frame, static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
              canvas.begin(0.1F, 0.1F, 0.1F);
              program.use();
              program.set("V", camera.view);
              program.set("P", camera.projection);
              set_blending(canvas.gl, Blending::premultiplied_over);
              canvas.gl.Enable(GL_CULL_FACE);
              canvas.gl.CullFace(GL_BACK);
              vertices.draw(box_triangles());
              canvas.gl.Disable(GL_CULL_FACE);
            };
          }};
}

}  // namespace adversary::casters
