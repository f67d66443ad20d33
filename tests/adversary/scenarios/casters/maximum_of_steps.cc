// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario maximum_of_steps() {
  return {
      .sentence = "The largest value along the ray through a table of sharp borders, steps a third of a texel.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        std::vector<Colour> colours = step_colours();
        for (Colour& colour : colours) colour[3] = 255;
        return [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                  {.before = "  float largest = 0.0;",
                                                   .each = "    largest = max(largest, value);",
                                                   .after = "  shown = texture(table, vec2(largest, 0.5));"}),
                                              .table = colours,
                                              .step_length = 1.0F / 144})](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
