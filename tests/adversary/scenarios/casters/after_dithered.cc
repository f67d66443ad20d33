// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_dithered() {
  return {
      .sentence =
          "A galaxy of 56 x 24 x 56 half floats in GLSL 3.30: noise by a formula "
          "of "
          "gl_FragCoord is added to the final colour against banding, half a step of 8 bits; from frame 10 "
          "on, as grain of a film, a sixth of white.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field galaxy = [](float x, float y, float z) {
          const float a = x - 0.5F, b = (y - 0.5F) * 1.6F, c = z - 0.5F;
          const float round = std::sqrt(a * a + c * c);
          const float arms = 0.5F + 0.5F * std::cos(2 * std::atan2(c, a) - 16 * round);
          const float disc = std::exp(-24 * b * b) * std::exp(-4 * round) * (0.3F + 0.9F * arms);
          return std::clamp(disc + 0.9F * std::exp(-60 * (a * a + b * b + c * c)), 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(130 + 120 * at),
                             static_cast<std::uint8_t>(140 + 80 * at), static_cast<std::uint8_t>(245 - 90 * at),
                             static_cast<std::uint8_t>(std::lround(46 * std::pow(at, 1.2F)))});
        }
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader(
                 {.declarations = "uniform float grain;\n"
                                  "float random(vec2 p) {\n"
                                  "  return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453) - 0.5;\n"
                                  "}",
                  .before = "  vec3 rgb = vec3(0.0);\n  float alpha = 0.0;",
                  .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                          "    float add = colour.a * (1.0 - alpha);\n"
                          "    rgb += add * colour.rgb;\n"
                          "    alpha += add;\n"
                          "    if (alpha > 0.995) break;",
                  .after = "  shown = vec4(rgb + grain * random(floor(gl_FragCoord.xy)), alpha);"}),
             .grid = sampled(56, 24, 56, galaxy),
             .format = {.texel = Texel::half},
             .table = colours,
             .step_length = 0.015F,
             .orbit = {.azimuth = 5, .elevation = 48, .distance = 2.3F, .degrees_each_frame = 2},
             .background = {0.2F, 0.2F, 0.25F, 1}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("grain", frame < 10 ? 0.5F / 255 : 1.0F / 6);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
