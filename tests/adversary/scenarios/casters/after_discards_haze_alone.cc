// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_discards_haze_alone() {
  return {
      .sentence =
          "Kernels of 0.3 a sample in haze of 0.008 a sample, 48 x 40 x 48 floats, GLSL 3.30: rays of an alpha "
          "below 0.05 are discarded after the loop, so that a few samples of haze show nothing, while many do.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field kernels = [](float x, float y, float z) {
          const float cells = std::sin(10 * x + 1) * std::sin(9 * y) * std::sin(10 * z + 2);
          const float haze = 0.25F + 0.15F * std::sin(5 * x + 4 * z) * std::cos(5 * y + 1);
          return std::clamp(std::max(haze, 1.6F * std::abs(cells) - 0.5F), 0.0F, 1.0F);
        };
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float kernel = std::clamp((at - 0.5F) / 0.2F, 0.0F, 1.0F);
          colours.push_back({static_cast<std::uint8_t>(230 - 60 * at),
                             static_cast<std::uint8_t>(220 - 140 * kernel),
                             static_cast<std::uint8_t>(240 - 190 * kernel),
                             static_cast<std::uint8_t>(std::lround(2 + 74 * kernel))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                                  "    if (sum.a > 0.99) break;",
                          .after = "  if (sum.a < 0.05) discard;\n  shown = sum;"}),
                     .grid = sampled(48, 40, 48, kernels),
                     .format = {.texel = Texel::float32},
                     .table = colours,
                     .step_length = 0.014F,
                     .orbit = {.azimuth = 220, .elevation = 20, .degrees_each_frame = 2.5F},
                     .background = {0.1F, 0.1F, 0.3F, 1}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
