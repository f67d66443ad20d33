// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_begun_again() {
  return {.sentence =
              "The mean of the values along the ray, begun again at every sample below a limit: what is shown "
              "is the mean of the ray's last part.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.before = "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    if (value < 0.3) {\n      sum = 0.0;\n      taken = 0u;\n    }\n"
                         "    sum += value;\n    ++taken;",
                 .after = "  shown = texture(table, vec2(sum / float(taken), 0.5));"});
            return [scene = caster_scene(canvas, {.fragment = shader, .table = opaque_colours()})](int frame) {
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
