// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_slightly_faded() {
  return {
      .sentence =
          "A chalk rock of 48 x 48 x 48 bytes in GLSL 3.30, bright before a dark window: a layer's opacity, "
          "which "
          "is multiplied to the whole result after the loop, is 1 until frame 9 and a little less from then "
          "on, "
          "0.98, 0.96 from frame 16 and 0.94 from frame 22 on.",
      .expectation = Expectation::either,
      .key_frames = {10, 16, 22},
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(255 - 30 * at), static_cast<std::uint8_t>(235 + 20 * at),
                             static_cast<std::uint8_t>(225 + 25 * std::sin(9 * at)),
                             static_cast<std::uint8_t>(std::lround(6 + 60 * at * at))});
        }
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader({.declarations = "uniform float layerOpacity;",
                                                 .before = "  vec4 c = vec4(0.0);",
                                                 .each = "    vec4 m = texture(table, vec2(value, 0.5));\n"
                                                         "    c.rgb = c.rgb + (1.0 - c.a) * m.a * m.rgb;\n"
                                                         "    c.a = c.a + (1.0 - c.a) * m.a;",
                                                 .after = "  c *= layerOpacity;\n  shown = c;"}),
             .grid = sampled(48, shells),
             .table = colours,
             .step_length = 0.02F,
             .orbit = {.azimuth = 100, .elevation = 15, .distance = 2.3F, .degrees_each_frame = 2},
             .background = {0, 0, 0.02F, 1}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("layerOpacity", frame < 10   ? 1.0F
                                             : frame < 16 ? 0.98F
                                             : frame < 22 ? 0.96F
                                                          : 0.94F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
