// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// Thin blue, black that hides nearly all, thin yellow.
std::vector<Colour> colours_with_black_ink() {
  std::vector<Colour> colours(256, Colour{0, 0, 0, 0});
  for (int i = 40; i < 256; ++i) {
    const auto brightness = static_cast<std::uint8_t>(i);
    colours[i] = i < 90    ? Colour{60, 120, 255, 12}
                 : i < 150 ? Colour{0, 0, 0, 160}
                           : Colour{brightness, brightness, 40, 40};
  }
  return colours;
}

}  // namespace

Scenario shader_background_black_with_blending() {
  return {
      .sentence =
          "The composed colour is shown over black with an alpha of 1, so blending by the alpha replaces an "
          "orange background. From frame 15 on the most opaque entries of the table are black.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = vec4(sum.rgb, 1.0);"}),
                     .blending = Blending::over,
                     .background = {0.9F, 0.45F, 0.1F, 1}});
        return [&canvas, scene](int frame) {
          if (frame == 15) {
            const auto colours = colours_with_black_ink();
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
