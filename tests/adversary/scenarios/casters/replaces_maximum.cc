// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_maximum() {
  return {.sentence = "Without blending: the largest value along the ray, through a table of opaque colours.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                   {.before = "  float largest = 0.0;",
                                                    .each = "    largest = max(largest, value);",
                                                    .after = "  shown = texture(table, vec2(largest, 0.5));"}),
                                               .table = opaque_colours(),
                                               .blending = Blending::off})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
