// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario average() {
  return {.sentence = "The mean of the values along the ray, through a table of opaque colours.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.fragment = caster_fragment_shader(
                                     {.before = "  float sum = 0.0;",
                                      .each = "    sum += value;",
                                      .after = "  shown = texture(table, vec2(sum / float(count), 0.5));"}),
                                 .table = opaque_colours()})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
