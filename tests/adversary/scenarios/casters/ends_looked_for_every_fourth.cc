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

const std::string ends_every_fourth_sample = R"(#version 420 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
layout(location = 0) out vec4 shown;

const float opaque = 0.97;

void main() {
  const vec3 ray = normalize(at - eye);
  const vec3 planes = (step(0.0, ray) - at) / ray;
  const int count = int(min(planes.x, min(planes.y, planes.z)) / step_length) + 1;
  const vec3 advance = step_length * ray;
  vec3 here = at;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    const vec4 c = texture(table, vec2(texture(volume, here).r, 0.5));
    sum += (1.0 - sum.a) * vec4(c.a * c.rgb, c.a);
    if ((i & 3) == 3 && sum.a > opaque) break;
    here += advance;
  }
  shown = sum;
}
)";

}  // namespace

Scenario ends_looked_for_every_fourth() {
  return {
      .sentence =
          "Dunes under a dense table in GLSL 4.20: whether alpha has passed 0.97 is looked at after every "
          "fourth sample only.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field dunes = [](float x, float y, float z) {
          const float height = 0.5F + 0.18F * std::sin(9 * x + 2 * z) + 0.12F * std::cos(11 * z - 3 * x);
          return std::clamp(0.5F + 1.1F * (height - y) + 0.12F * std::sin(25 * (x + z) - 12 * y), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(250 - 120 * at * at),
                           static_cast<std::uint8_t>(210 - 150 * at),
                           static_cast<std::uint8_t>(90 + 110 * std::sin(9 * at) * std::sin(9 * at)),
                           static_cast<std::uint8_t>(std::lround(6 + 84 * at))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = ends_every_fourth_sample,
                     .grid = sampled(60, 40, 52, dunes),
                     .table = table,
                     .step_length = 1.0F / 56,
                     .orbit = {.azimuth = 75, .elevation = 28, .distance = 2.6F, .degrees_each_frame = 1.3F},
                     .background = {0.3F, 0.55F, 0.85F, 1}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
