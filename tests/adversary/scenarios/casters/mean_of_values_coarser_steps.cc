// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_of_values_coarser_steps() {
  return {.sentence =
              "The mean of the values along the ray, through a table of opaque colours; steps are longer in "
              "frames 12 to 21.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {12, 22},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader =
                caster_fragment_shader({.before = "  float sum = 0.0;\n  uint taken = 0u;",
                                        .each = "    sum += value;\n    ++taken;",
                                        .after = "  shown = texture(table, vec2(sum / float(taken), 0.5));"});
            auto scene = caster_scene(
                canvas, {.fragment = shader, .grid = sampled(48, shells), .table = opaque_colours()});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("step_length", frame < 12 || frame >= 22 ? 0.025F : 0.07F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
