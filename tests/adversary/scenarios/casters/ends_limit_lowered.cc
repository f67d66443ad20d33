// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

const std::string ends_at_a_uniform = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
uniform float opacity_limit;
in vec3 at;
out vec4 shown;

void main() {
  vec3 ray = normalize(at - eye);
  vec3 planes = (step(0.0, ray) - at) / ray;
  float end = min(planes.x, min(planes.y, planes.z));
  vec4 sum = vec4(0.0);
  float t = 0.0;
  while (t <= end && sum.a < opacity_limit) {
    vec4 c = texture(table, vec2(texture(volume, at + t * ray).r, 0.5));
    c.rgb *= c.a;
    sum += (1.0 - sum.a) * c;
    t += step_length;
  }
  shown = sum;
}
)";

}  // namespace

Scenario ends_limit_lowered() {
  return {.sentence =
              "Dark red wood before a bright background in GLSL 3.30; a sample is taken while alpha is below a "
              "uniform, which is 0.995, 0.9 from frame 10 on, and 0.97 from frame 20 on.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            const Field wood = [](float x, float y, float z) {
              const float a = x - 0.3F + 0.08F * std::sin(6 * y), b = z - 0.4F;
              const float rings = std::sin(30 * std::sqrt(a * a + b * b) + 2 * y);
              return std::clamp(0.5F + 0.3F * rings + 0.2F * std::sin(5 * y + 7 * x * z), 0.0F, 1.0F);
            };
            std::vector<Colour> table;
            for (int i = 0; i < 256; ++i) {
              const float at = static_cast<float>(i) / 255;
              table.push_back({static_cast<std::uint8_t>(90 + 110 * at),
                               static_cast<std::uint8_t>(20 + 90 * at * at),
                               static_cast<std::uint8_t>(30 + 40 * std::sin(6 * at) * std::sin(6 * at)),
                               static_cast<std::uint8_t>(std::lround(14 + 36 * at))});
            }
            auto scene = caster_scene(
                canvas,
                {.fragment = ends_at_a_uniform,
                 .grid = sampled(56, wood),
                 .table = table,
                 .step_length = 0.015F,
                 .orbit = {.azimuth = 60, .elevation = 24, .distance = 2.5F, .degrees_each_frame = 1.5F},
                 .background = {0.95F, 0.95F, 0.9F, 1}});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("opacity_limit", frame < 10 ? 0.995F : frame < 20 ? 0.9F : 0.97F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
