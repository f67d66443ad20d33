// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_cut_short() {
  return {.sentence =
              "The mean of the values along the ray as a grey; from frame 13 on it ends where the samples' "
              "opacities hide half of what is behind.",
          .expectation = Expectation::either,
          .key_frames = {13},
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string shader = caster_fragment_shader(
                {.declarations = "uniform float limit;",
                 .before = "  float sum = 0.0;\n  float hidden = 0.0;\n  uint taken = 0u;",
                 .each = "    sum += value;\n    ++taken;\n"
                         "    hidden += (1.0 - hidden) * texture(table, vec2(value, 0.5)).a;\n"
                         "    if (hidden > limit) break;",
                 .after = "  shown = vec4(vec3(clamp(sum / float(taken), 0.0, 1.0)), 1.0);"});
            auto scene = caster_scene(canvas, {.fragment = shader});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("limit", frame < 13 ? 2.0F : 0.5F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
