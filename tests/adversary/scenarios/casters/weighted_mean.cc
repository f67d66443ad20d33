// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario weighted_mean() {
  return {.sentence = "The mean of the values along the ray, in which later samples weigh more.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.before = "  float sum = 0.0;\n  float weights = 0.0;\n  float weight = 1.0;",
                 .each = "    sum += weight * value;\n    weights += weight;\n    weight *= 1.03;",
                 .after = "  shown = vec4(vec3(sum / max(weights, 1e-6)), 1.0);"});
            return [scene = caster_scene(canvas, {.fragment = shader})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
