// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario ends_where_red_is_full() {
  return {
      .sentence =
          "Embers whose rays end where the red that they have gathered passes 0.55, whatever their alpha.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field embers = [](float x, float y, float z) {
          const float glow =
              std::sin(10 * x + 2 * std::sin(5 * z)) * std::cos(9 * y + 1) + 0.7F * std::sin(11 * z - 4 * y);
          return std::clamp(0.45F + 0.25F * glow + 0.25F * (x - z), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          table.push_back({static_cast<std::uint8_t>(40 + 215 * at), static_cast<std::uint8_t>(200 - 150 * at),
                           static_cast<std::uint8_t>(60 + 120 * (1 - at) * (1 - at)),
                           static_cast<std::uint8_t>(std::lround(10 + 45 * at))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);\n"
                                  "    if (sum.r > 0.55) break;",
                          .after = "  shown = sum;"}),
                     .grid = sampled(44, embers),
                     .table = table,
                     .step_length = 0.02F,
                     .orbit = {.azimuth = 320, .elevation = 30, .distance = 2.5F, .degrees_each_frame = 4}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
