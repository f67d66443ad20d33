// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_of_squares() {
  return {.sentence =
              "The root of the mean of the squared values along the ray, through a table of opaque colours.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.before = "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    sum += value * value;\n    ++taken;",
                 .after = "  shown = texture(table, vec2(sqrt(sum / max(float(taken), 1.0)), 0.5));"});
            return [scene = caster_scene(canvas, {.fragment = shader, .table = opaque_colours()})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
