// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_by_a_least_count() {
  return {.sentence =
              "The mean of the values along the ray as a grey; from frame 14 on the sum is divided by 45 at "
              "least, so that short rays are darker.",
          .expectation = Expectation::either,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform int least;",
                 .before = "  float sum = 0.0;\n  int taken = 0;",
                 .each = "    sum += value;\n    ++taken;",
                 .after = "  shown = vec4(vec3(clamp(sum / float(max(taken, least)), 0.0, 1.0)), 1.0);"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("least", frame < 14 ? 1 : 45);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
