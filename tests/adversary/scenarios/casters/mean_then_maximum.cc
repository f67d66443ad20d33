// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mean_then_maximum() {
  return {
      .sentence =
          "The mean of the values along the ray as a grey; a uniform makes it the maximum from frame 10 on.",
      .expectation = Expectation::either,
      .key_frames = {10, 20},
      .start = [](Canvas& canvas) -> DrawFrame {
        const std::string shader = caster_fragment_shader(
            {.declarations = "uniform int mode;",
             .before = "  float sum = 0.0;\n  float largest = 0.0;\n  uint taken = 0u;",
             .each = "    sum += value;\n    largest = max(largest, value);\n    ++taken;",
             .after = "  float grey = mode == 0 ? sum / float(taken) : largest;\n"
                      "  shown = vec4(vec3(grey), 1.0);"});
        auto scene = caster_scene(canvas, {.fragment = shader});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("mode", frame < 10 || frame >= 20 ? 0 : 1);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
