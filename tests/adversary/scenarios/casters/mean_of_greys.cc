// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_of_greys() {
  return {.sentence = "The mean of opacity times value along the ray, as VTK's average intensity.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.before = "  float sum = 0.0;\n  uint taken = 0u;",
                 .each = "    sum += texture(table, vec2(value, 0.5)).a * value;\n    ++taken;",
                 .after = "  if (taken == 0u) discard;\n"
                          "  shown = vec4(vec3(clamp(sum / float(taken), 0.0, 1.0)), 1.0);"});
            return [scene = caster_scene(canvas, {.fragment = shader})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
