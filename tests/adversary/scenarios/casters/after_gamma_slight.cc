// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_gamma_slight() {
  return {
      .sentence =
          "Marbled fat of 52 x 52 x 40 16-bit texels in GLSL 3.30, rays end at 0.97: a slight gamma of the "
          "composed colour, 1.03 at first, 1.07 from frame 10 on, and 1.1 from frame 20 on.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<Colour> colours;
        for (int i = 0; i < 256; ++i) {
          const float at = static_cast<float>(i) / 255;
          colours.push_back({static_cast<std::uint8_t>(120 + 40 * std::sin(8 * at)),
                             static_cast<std::uint8_t>(90 + 30 * at), static_cast<std::uint8_t>(100 - 40 * at),
                             static_cast<std::uint8_t>(std::lround(4 + 46 * at * at))});
        }
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform float inverse_gamma;",
                          .before = "  vec3 lit = vec3(0.0);\n  float hidden = 0.0;",
                          .each = "    vec4 entry = texture(table, vec2(value, 0.5));\n"
                                  "    lit += (1.0 - hidden) * entry.a * entry.rgb;\n"
                                  "    hidden += (1.0 - hidden) * entry.a;\n"
                                  "    if (hidden >= 0.97) break;",
                          .after = "  shown = vec4(pow(lit, vec3(inverse_gamma)), hidden);"}),
                     .grid = sampled(52, 52, 40, waves),
                     .format = {.texel = Texel::unsigned16},
                     .table = colours,
                     .step_length = 0.018F,
                     .orbit = {.azimuth = 160, .elevation = 24, .distance = 2.4F, .degrees_each_frame = 2}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("inverse_gamma", 1.0F / (frame < 10 ? 1.03F : frame < 20 ? 1.07F : 1.1F));
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
