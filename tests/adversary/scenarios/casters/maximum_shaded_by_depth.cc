// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario maximum_shaded_by_depth() {
  return {.sentence = "A maximum whose colour darkens with the depth at which it lies.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return
                [scene = caster_scene(canvas, {.fragment = caster_fragment_shader(
                                                   {.before = "  float largest = 0.0, depth = 0.0;",
                                                    .each = "    if (value > largest) {\n"
                                                            "      largest = value;\n"
                                                            "      depth = float(i) * step_length;\n"
                                                            "    }",
                                                    .after = "  shown = texture(table, vec2(largest, 0.5));\n"
                                                             "  shown.rgb *= 1.0 - 0.5 * depth;"}),
                                               .table = opaque_colours()})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
