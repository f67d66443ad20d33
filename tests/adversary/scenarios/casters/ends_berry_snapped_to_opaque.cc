// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario ends_berry_snapped_to_opaque() {
  return {
      .sentence =
          "A berry with a dense stone in a translucent skin in GLSL 3.30: rays end where alpha passes 0.98, "
          "and an alpha beyond that is set to 1 after the loop.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field berry = [](float x, float y, float z) {
          const float a = x - 0.48F, b = y - 0.5F, c = z - 0.53F;
          const float radius = std::sqrt(a * a + b * b + c * c);
          const float bumps = 0.05F * std::sin(18 * x + 2) * std::cos(16 * y) + 0.04F * std::sin(17 * z);
          return std::clamp(1.05F - 2.1F * radius + bumps + 0.08F * std::sin(9 * (x - y + z)), 0.0F, 1.0F);
        };
        std::vector<Colour> table;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          const float stone = std::clamp((at - 0.5F) / 0.3F, 0.0F, 1.0F);
          const float skin = std::clamp(1 - std::abs(at - 0.3F) / 0.15F, 0.0F, 1.0F);
          table.push_back({static_cast<std::uint8_t>(200 - 100 * at),
                           static_cast<std::uint8_t>(30 + 190 * stone),
                           static_cast<std::uint8_t>(120 + 60 * std::sin(5 * at)),
                           static_cast<std::uint8_t>(std::lround(14 * skin + 50 * stone))});
        }
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader({.before = "  vec3 rgb = vec3(0.0);\n"
                                                           "  float a = 0.0;",
                                                 .each = "    vec4 c = texture(table, vec2(value, 0.5));\n"
                                                         "    rgb += (1.0 - a) * c.a * c.rgb;\n"
                                                         "    a += (1.0 - a) * c.a;\n"
                                                         "    if (a > 0.98) break;",
                                                 .after = "  if (a > 0.98) a = 1.0;\n"
                                                          "  shown = vec4(rgb, a);"}),
             .grid = sampled(48, berry),
             .table = table,
             .step_length = 0.02F,
             .orbit = {.azimuth = 250, .elevation = -18, .distance = 2.4F, .degrees_each_frame = 2},
             .background = {0.85F, 0.9F, 0.8F, 1}});
        return [scene](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
