// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

namespace {

constexpr int middle = 128;

/// Grey levels, thin but for those around the middle one.
std::vector<Colour> greys_opaque_in_the_middle() {
  std::vector<Colour> colours(256, Colour{0, 0, 0, 0});
  for (int i = 0; i < 256; ++i) {
    const auto grey = static_cast<std::uint8_t>(i);
    const int thin = std::clamp(i - 60, 0, 20);
    colours[i] =
        Colour{grey, grey, grey, static_cast<std::uint8_t>(std::max(thin, 200 - 8 * std::abs(i - middle)))};
  }
  return colours;
}

}  // namespace

Scenario shader_background_among_the_greys() {
  return {.sentence =
              "Without blending, a table of greys over a grey that is one of the table's own: the most opaque "
              "value has exactly the background's colour, and hides the lighter and darker ones behind it. "
              "Another volume comes at frame 12.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = caster_fragment_shader(
                             {.declarations = "uniform float background;",
                              .before = "  float grey = 0.0;\n  float alpha = 0.0;",
                              .each = "    vec4 colour = texture(table, vec2(value, 0.5));\n"
                                      "    grey += (1.0 - alpha) * colour.a * colour.r;\n"
                                      "    alpha += (1.0 - alpha) * colour.a;",
                              .after = "  shown = vec4(vec3(grey + (1.0 - alpha) * background), 1.0);"}),
                         .table = greys_opaque_in_the_middle(),
                         .blending = Blending::off,
                         .background = {0.2F, 0.3F, 0.7F, 1}});
            return [&canvas, scene](int frame) {
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              if (frame == 12) replace_texels(canvas, sampled(48, shells), scene->settings.format);
              scene->program.use();
              scene->program.set("background", static_cast<float>(middle) / 255);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
