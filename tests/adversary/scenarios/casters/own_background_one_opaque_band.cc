// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

/// From orange to yellow; only 24 values from `first` on are visible.
std::vector<Colour> band_from(int first) {
  std::vector<Colour> colours(256, Colour{0, 0, 0, 0});
  for (int i = 0; i < 256; ++i) {
    const bool visible = i >= first && i < first + 24;
    colours[i] = Colour{240, static_cast<std::uint8_t>(60 + i / 2), static_cast<std::uint8_t>(90 - i / 4),
                        static_cast<std::uint8_t>(visible ? 225 : 0)};
  }
  return colours;
}

}  // namespace

Scenario own_background_one_opaque_band() {
  return {
      .sentence =
          "Without blending, over slate blue in the shader, with an alpha of 1; 16 bits a voxel and short "
          "steps. The table is invisible but for one very opaque band of 24 values, which is moved up at frame "
          "15.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {15},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = caster_fragment_shader(
                         {.declarations = "uniform vec3 background;",
                          .before = "  vec4 sum = vec4(0.0);",
                          .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                  "    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);",
                          .after = "  shown = vec4(sum.rgb + (1.0 - sum.a) * background, 1.0);"}),
                     .format = {.texel = Texel::unsigned16},
                     .table = band_from(105),
                     .blending = Blending::off,
                     .step_length = 0.0125F,
                     .background = {0.9F, 0.9F, 0.9F, 1}});
        scene->program.set("background", Vector{0.25F, 0.3F, 0.45F});
        return [&canvas, scene](int frame) {
          if (frame == 15) {
            const auto colours = band_from(150);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
