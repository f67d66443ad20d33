// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_table_edited_between() {
  return {.sentence =
              "Two settings take turns, two frames each. Whenever the second is drawn, a few entries of the "
              "table are "
              "edited, which the first must show when it comes back: 24 of them, at another place each time.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster("uniform vec3 warmth;", R"(
    colour.rgb *= warmth;)")});
            return [&canvas, scene](int frame) {
              if (frame % 4 == 3) {
                std::vector<Colour> colours = soft_colours();
                const int first = 30 + 37 * (frame / 4) % 180;
                for (int i = first; i < first + 24; ++i)
                  colours[static_cast<std::size_t>(i)] = {250, 40, 200, 50};
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        colours.data());
              }
              scene->program.use();
              scene->program.set("warmth", frame % 4 < 2 ? Vector{1, 1, 1} : Vector{1, 0.7F, 0.4F});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
