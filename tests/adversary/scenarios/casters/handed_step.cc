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

Scenario handed_step() {
  return {
      .sentence =
          "A nutmeg of 52 x 56 x 48 bytes in GLSL 4.20. A uniform of the vertex shader scales the box, and "
          "the step, of one length in the world, is divided by it and handed on flat; opacities are as the "
          "table has them, so that a larger box is denser. The camera turns but in frames 8 to 16, when the "
          "user zooms by the scale.",
      .expectation = Expectation::either,
      .key_frames = {8, 9, 10, 11, 12, 13, 14, 15, 16},
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, R"(#version 420 core
layout(location = 0) in vec3 corner;

uniform mat4 clipFromWorld;
uniform vec3 eye;
uniform float worldStep;
uniform float scale;

out vec3 place;
out vec3 away;
flat out float stepLength;

void main() {
  vec3 eyeInVolume = (eye - 0.5) / scale + 0.5;
  place = corner;
  away = corner - eyeInVolume;
  stepLength = worldStep / scale;
  gl_Position = clipFromWorld * vec4((corner - 0.5) * scale + 0.5, 1.0);
}
)",
                                  R"(#version 420 core
layout(binding = 0) uniform sampler3D nutmeg;
layout(binding = 1) uniform sampler1D lookup;

in vec3 place;
in vec3 away;
flat in float stepLength;
layout(location = 0) out vec4 pixel;

void main() {
  vec3 direction = normalize(away);
  vec3 walls = (step(0.0, direction) - place) / direction;
  float leave = min(walls.x, min(walls.y, walls.z));

  vec4 sum = vec4(0.0);
  for (float t = 0.5 * stepLength; t < leave; t += stepLength) {
    vec4 colour = texture(lookup, texture(nutmeg, place + t * direction).r);
    colour.rgb *= colour.a;
    sum += (1.0 - sum.a) * colour;
  }
  pixel = sum;
}
)");
        const VertexBuffer vertices(canvas);
        const Field nutmeg = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.49F, c = z - 0.5F;
          const float away = std::sqrt(1.15F * a * a + 0.85F * b * b + 1.2F * c * c);
          // Veins that fold.
          const float folds = std::sin(15 * a + 2.5F * std::sin(9 * b + 5 * c) + 1) *
                              std::cos(13 * c + 2.2F * std::cos(10 * b - 6 * a));
          const float body = std::clamp(6.2F - 14 * away, 0.0F, 1.0F);
          const float rind = std::exp(-210 * (away - 0.4F) * (away - 0.4F));
          return std::clamp(
              0.06F + body * (0.36F + 0.34F * folds) + 0.3F * rind + 0.04F * std::sin(9 * y - 5 * x), 0.0F,
              1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float vein = std::clamp((at - 0.2F) / 0.5F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(240 - 90 * vein),
                           static_cast<std::uint8_t>(190 - 120 * std::sin(2.9F * at)),
                           static_cast<std::uint8_t>(80 + 120 * vein * vein),
                           static_cast<std::uint8_t>(std::lround(1 + 3 * at + 15 * vein))});
        }
        upload_volume(canvas, 0, sampled(52, 56, 48, nutmeg));
        upload_table_1d(canvas, 1, table);
        program.use();
        program.set("worldStep", 0.0165F);
        return [&canvas, program, vertices](int frame) {
          const int turned = std::min(frame, 7) + std::max(frame - 16, 0);
          const Camera camera =
              camera_at({.azimuth = 48, .elevation = 18, .distance = 2.4F, .degrees_each_frame = 1.5F}, turned,
                        static_cast<float>(canvas.width()) / static_cast<float>(canvas.height()));
          canvas.begin(0.08F, 0.11F, 0.18F);
          program.use();
          program.set("clipFromWorld", camera.clip_from_object());
          program.set("eye", camera.eye);
          program.set("scale", 0.75F + 0.05F * static_cast<float>(std::clamp(frame - 7, 0, 9)));
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
