// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario first_maximum() {
  return {
      .sentence = "The first maximum above a threshold, not the largest one.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        return [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                  {.before = "  float largest = 0.0;",
                                                   .each = "    if (largest > 0.55 && value < largest) break;\n"
                                                           "    largest = max(largest, value);",
                                                   .after = "  shown = texture(table, vec2(largest, 0.5));"}),
                                              .table = opaque_colours()})](int frame) { scene->draw(frame); };
      }};
}

}  // namespace adversary::casters
