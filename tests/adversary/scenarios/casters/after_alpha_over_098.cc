// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario after_alpha_over_098() {
  return {
      .sentence =
          "An onion of 44 x 44 x 44 half floats in GLSL 3.30 before a bright window: rays end at 0.98, and "
          "colour and alpha are divided by 0.98 and clamped to 1 after the loop. From frame 12 on the core, "
          "dense, is larger.",
      .expectation = Expectation::either,
      .key_frames = {12},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Field onion = [](float x, float y, float z) {
          const float a = x - 0.5F, b = y - 0.45F, c = z - 0.5F;
          const float radius = std::sqrt(a * a + 0.8F * b * b + c * c);
          return std::clamp(1.0F - 1.9F * radius + 0.08F * std::sin(70 * radius + 3 * std::atan2(c, a)), 0.0F,
                            1.0F);
        };
        const auto table_of = [](float core_begins) {
          std::vector<Colour> colours;
          for (int i = 0; i < 256; ++i) {
            const float at = static_cast<float>(i) / 255;
            const float core = std::clamp((at - core_begins) / 0.2F, 0.0F, 1.0F);
            colours.push_back(
                {static_cast<std::uint8_t>(150 - 90 * core),
                 static_cast<std::uint8_t>(60 + 90 * std::sin(11 * at)),
                 static_cast<std::uint8_t>(110 + 60 * at),
                 static_cast<std::uint8_t>(std::lround(16 * std::min(1.0F, 3 * at) + 90 * core))});
          }
          return colours;
        };
        auto scene = caster_scene(
            canvas,
            {.fragment = caster_fragment_shader({.declarations = "const float LIMIT = 0.98;",
                                                 .before = "  vec4 acc = vec4(0.0);",
                                                 .each = "    vec4 src = texture(table, vec2(value, 0.5));\n"
                                                         "    src.rgb *= src.a;\n"
                                                         "    acc = acc + (1.0 - acc.a) * src;\n"
                                                         "    if (acc.a > LIMIT) break;",
                                                 .after = "  shown = min(acc / LIMIT, vec4(1.0));"}),
             .grid = sampled(44, onion),
             .format = {.texel = Texel::half},
             .table = table_of(0.6F),
             .step_length = 0.018F,
             .orbit = {.azimuth = 30, .elevation = 40, .distance = 2.3F, .degrees_each_frame = 2},
             .background = {0.95F, 1, 0.9F, 1}});
        return [scene, table_of](int frame) {
          if (frame == 12) {
            const auto colours = table_of(0.4F);
            scene->canvas.gl.ActiveTexture(GL_TEXTURE1);
            scene->canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                           colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
