// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_toon_with_outlines() {
  return {
      .sentence =
          "Light from the eye in three tones, and dark outlines where surfaces turn away from it; rays end "
          "where "
          "they are nearly opaque.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        // A bunch of balloons of two values over a wavy floor.
        const Field field = [](float x, float y, float z) {
          float rest = 1 - 0.4F / (1 + std::exp(30 * (y - 0.2F - 0.05F * std::sin(10 * x + 4 * z))));
          for (int i = 0; i < 6; ++i) {
            const float at = static_cast<float>(i);
            const float a = x - 0.5F - 0.25F * std::cos(1.9F * at), b = y - 0.38F - 0.08F * at,
                        c = z - 0.5F - 0.25F * std::sin(1.9F * at);
            rest *= 1 - (i % 2 == 0 ? 0.9F : 0.65F) * std::exp(-70 * (a * a + 0.8F * b * b + c * c));
          }
          return 1 - rest;
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float floor = std::exp(-std::pow((at - 0.27F) / 0.06F, 2.0F));
          const float skin = at > 0.42F ? 1 - std::exp(-std::pow((at - 0.42F) / 0.1F, 2.0F)) : 0;
          table.push_back({static_cast<std::uint8_t>(60 + 190 * skin),
                           static_cast<std::uint8_t>(200 - 110 * at), static_cast<std::uint8_t>(240 - 180 * at),
                           static_cast<std::uint8_t>(std::lround(36 * floor + 110 * skin))});
        }
        auto scene = caster_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
uniform vec3 eye;
uniform float step_length;
in vec3 at;
out vec4 shown;

const vec2 k = vec2(1.0 / 64.0, 0.0);

vec3 normal(vec3 p) {
  vec3 g = vec3(texture(volume, p - k.xyy).r - texture(volume, p + k.xyy).r,
                texture(volume, p - k.yxy).r - texture(volume, p + k.yxy).r,
                texture(volume, p - k.yyx).r - texture(volume, p + k.yyx).r);
  return g / max(length(g), 1e-6);
}

vec3 cel(vec3 paint, float lambert) {
  float tone = 0.35 + 0.3 * (floor(3.0 * lambert) / 2.0);
  float outline = smoothstep(0.2, 0.35, lambert);
  return mix(vec3(0.02), paint * min(tone, 1.0), outline);
}

void main() {
  vec3 rd = normalize(at - eye);
  vec3 ends = (step(0.0, rd) - at) / rd;
  float far = min(ends.x, min(ends.y, ends.z));
  vec4 acc = vec4(0.0);
  for (float t = 0.0; t < far; t += step_length) {
    vec3 p = at + t * rd;
    vec4 c = texture(table, vec2(texture(volume, p).r, 0.5));
    if (c.a > 0.0) {
      c.rgb = cel(c.rgb, abs(dot(normal(p), rd)));
      acc += (1.0 - acc.a) * vec4(c.rgb * c.a, c.a);
      if (acc.a > 0.97) break;
    }
  }
  shown = acc;
}
)",
                                           .grid = sampled(64, field),
                                           .table = table,
                                           .step_length = 0.018F,
                                           .orbit = {.azimuth = 45, .elevation = 18, .degrees_each_frame = 2}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
