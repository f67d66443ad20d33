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

const std::string at_most_128 = R"(#version 330 core
#define MAX_STEPS 128
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

bool inside(vec3 p) { return all(greaterThanEqual(p, vec3(0.0))) && all(lessThanEqual(p, vec3(1.0))); }

void main() {
  vec3 delta = step_length * normalize(at - eye);
  vec3 p = at + 0.5 * delta;
  vec4 acc = vec4(0.0);
  for (int i = 0; i < MAX_STEPS && inside(p); ++i, p += delta) {
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    acc += (1.0 - acc.a) * vec4(c.rgb * c.a, c.a);
  }
  shown = acc;
}
)";

}  // namespace

Scenario place_lung_128_samples() {
  return {
      .sentence =
          "A lung of 60 bytes an edge whose loop ends after 128 samples, which are enough for rays straight "
          "through the box, as in the first frames, but not for those along its diagonals, which the camera "
          "turns "
          "to.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field lung = [](float x, float y, float z) {
          const float left = std::hypot((x - 0.27F) / 0.2F, (y - 0.5F) / 0.4F, (z - 0.5F) / 0.3F);
          const float right = std::hypot((x - 0.73F) / 0.22F, (y - 0.52F) / 0.42F, (z - 0.48F) / 0.32F);
          const float wall = std::exp(-std::pow((std::min(left, right) - 1) / 0.15F, 2.0F));
          const float vessels = std::abs(std::sin(11 * x + 4 * std::sin(6 * y)) * std::sin(13 * z + 5 * x * y));
          return std::clamp(0.6F * wall + 0.35F * vessels + 0.25F * z, 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float v = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(230 - 90 * v),
                             static_cast<std::uint8_t>(90 + 130 * v * v),
                             static_cast<std::uint8_t>(110 + 120 * std::sin(4 * v)),
                             static_cast<std::uint8_t>(std::lround(2 + 7 * v))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = at_most_128,
                     .grid = sampled(60, lung),
                     .table = colours,
                     .step_length = 0.0088F,
                     .orbit = {.azimuth = 0, .elevation = 1, .distance = 3, .degrees_each_frame = 1.7F}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
