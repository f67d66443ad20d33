// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario ends_mist_with_a_wall_behind() {
  return {
      .sentence =
          "Thin mist with a dense wall at its back in GLSL 3.30: rays end where alpha passes 0.9, at first "
          "few, and only in the wall; the camera turns by 6 degrees a frame until it looks on the wall.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        // The eye begins at positive z: the wall is at the other end.
        const Field mist = [](float x, float y, float z) {
          const float patches =
              std::sin(8 * x + 3 * y) * std::cos(7 * z + 1) + 0.6F * std::sin(12 * y - 5 * x * z);
          const float wall = std::clamp((0.2F + 0.05F * std::sin(9 * x + 7 * y) - z) / 0.1F, 0.0F, 1.0F);
          return std::clamp(0.3F + 0.15F * patches + 0.45F * wall, 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float dense = std::clamp((at - 0.6F) / 0.3F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(230 - 180 * dense),
                           static_cast<std::uint8_t>(150 + 90 * std::sin(10 * at)),
                           static_cast<std::uint8_t>(60 + 170 * at),
                           static_cast<std::uint8_t>(std::lround(2 + 8 * at + 60 * dense))});
        }
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader({.before = "  vec4 sum = vec4(0.0);",
                                                 .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                                         "    colour.rgb *= colour.a;\n"
                                                         "    sum = sum + (1.0 - sum.a) * colour;\n"
                                                         "    if (sum.a > 0.9)\n"
                                                         "      break;",
                                                 .after = "  shown = sum;"}),
             .grid = sampled(48, mist),
             .table = table,
             .step_length = 0.02F,
             .orbit = {.azimuth = 10, .elevation = 14, .distance = 2.6F, .degrees_each_frame = 6},
             .background = {0.9F, 0.85F, 0.95F, 1}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
