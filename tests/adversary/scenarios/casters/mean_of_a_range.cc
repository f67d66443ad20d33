// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_of_a_range() {
  return {.sentence =
              "The mean of opacity times value over the samples within a range, as VTK's average intensity; "
              "the range is narrowed at frame 9 and moved at frame 19.",
          .expectation = Expectation::either,
          .key_frames = {9, 19},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform float low, high;",
                 .before = "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    if (low <= value && value <= high) {\n"
                         "      float opacity = texture(table, vec2(value, 0.5)).g;\n"
                         "      sum += opacity * value;\n"
                         "      ++taken;\n"
                         "    }",
                 .after = "  shown = vec4(0.0);\n"
                          "  if (taken > 0u) shown = vec4(vec3(clamp(sum / float(taken), 0.0, 1.0)), 1.0);"});
            auto scene = caster_scene(canvas, {.fragment = shader, .table = opaque_colours()});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("low", frame < 9 ? 0.0F : frame < 19 ? 0.35F : 0.65F);
              scene->program.set("high", frame < 9 ? 1.0F : frame < 19 ? 0.7F : 0.9F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
