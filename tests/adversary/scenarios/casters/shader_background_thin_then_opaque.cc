// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// Opacity rises from nothing at `from` by `slope` an entry, to `most`.
std::vector<Colour> rising_opacity(int from, int slope, int most) {
  std::vector<Colour> colours(256, Colour{0, 0, 0, 0});
  for (int i = 0; i < 256; ++i) {
    colours[i] = Colour{static_cast<std::uint8_t>(255 - i / 2), static_cast<std::uint8_t>(i),
                        static_cast<std::uint8_t>(i < 128 ? 2 * i : 510 - 2 * i),
                        static_cast<std::uint8_t>(std::clamp(slope * (i - from), 0, most))};
  }
  return colours;
}

}  // namespace

Scenario shader_background_thin_then_opaque() {
  return {
      .sentence =
          "Over dark blue, with the light that is let through kept instead of an alpha; a ray ends when less "
          "than a 200th is. The table is very thin, from frame 10 on opaque within a few entries, and from "
          "frame 20 on thin again, for other values.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "",
                          .before = "  vec3 light = vec3(0.0);\n  float through = 1.0;",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    light += through * colour.a * colour.rgb;\n"
                                  "    through *= 1.0 - colour.a;\n"
                                  "    if (through < 0.005) break;",
                          .after = "  shown = vec4(light + through * vec3(0.05, 0.1, 0.35), 1.0);"}),
                     .table = rising_opacity(90, 1, 4),
                     .blending = Blending::over,
                     .background = {0.8F, 0.8F, 0.75F, 1}});
        return [&canvas, scene](int frame) {
          if (frame == 10 || frame == 20) {
            const auto colours = frame == 10 ? rising_opacity(110, 10, 255) : rising_opacity(150, 1, 6);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
