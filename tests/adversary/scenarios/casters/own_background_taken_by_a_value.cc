// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

constexpr Colour sand{153, 140, 102, 255};

/// The soft colours, but for a band of values in the middle.
std::vector<Colour> with_band(Colour colour, std::uint8_t opacity) {
  std::vector<Colour> colours = soft_colours();
  for (int i = 116; i < 146; ++i) colours[i] = Colour{colour[0], colour[1], colour[2], opacity};
  return colours;
}

}  // namespace

Scenario own_background_taken_by_a_value() {
  return {
      .sentence =
          "Without blending, over sand in the shader, with an alpha of 1. A band of the table has no "
          "opacity; from frame 10 on it has exactly the background's colour and hides what is behind it, "
          "and from frame 20 on it is as opaque in blue.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene =
            caster_scene(canvas, {.fragment = caster_fragment_shader(
                                      {.declarations = "const vec3 sand = vec3(153.0, 140.0, 102.0) / 255.0;",
                                       .before = "  vec4 sum = vec4(0.0);",
                                       .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                               "    colour.rgb *= colour.a;\n"
                                               "    sum += (1.0 - sum.a) * colour;",
                                       .after = "  shown = vec4(sum.rgb + (1.0 - sum.a) * sand, 1.0);"}),
                                  .table = with_band(sand, 0),
                                  .blending = Blending::off,
                                  .background = {0.2F, 0.2F, 0.5F, 1}});
        return [&canvas, scene](int frame) {
          if (frame == 10 || frame == 20) {
            const auto colours = with_band(frame == 10 ? sand : Colour{30, 60, 220, 255}, 150);
            canvas.gl.ActiveTexture(GL_TEXTURE1);
            canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
