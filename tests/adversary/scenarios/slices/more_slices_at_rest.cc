// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario more_slices_at_rest() {
  return {.sentence = "While the user drags, 32 slices, otherwise 96; a uniform corrects the opacity.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {8, 16, 24},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.fragment = slice_fragment_shader("uniform float spacing;", R"(
  colour.a = 1.0 - pow(1.0 - colour.a, spacing);)")})](int frame) {
              scene->settings.slices = frame / 8 % 2 == 0 ? 96 : 32;
              scene->program.use();
              scene->program.set("spacing", 64.0F / static_cast<float>(scene->settings.slices));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
