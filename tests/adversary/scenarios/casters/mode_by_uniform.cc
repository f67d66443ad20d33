// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario mode_by_uniform() {
  return {.sentence = "A uniform chooses between over, maximum (frame 7), average (14) and first hit (21).",
          .expectation = Expectation::either,
          .key_frames = {7, 14, 21},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(
                        canvas, {.fragment = caster_fragment_shader(
                                     {.declarations = "uniform int mode;",
                                      .before = "  vec4 sum = vec4(0.0);\n  float largest = 0.0, all = 0.0;",
                                      .each = R"(
    vec4 colour = texture(table, vec2(value, 0.5));
    if (mode == 3 && value > 0.6) {
      sum = vec4(colour.rgb, 1.0);
      break;
    }
    largest = max(largest, value);
    all += value;
    if (mode == 0) sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);)",
                                      .after = R"(
  if (mode == 1) sum = vec4(texture(table, vec2(largest, 0.5)).rgb, 1.0);
  if (mode == 2) sum = vec4(texture(table, vec2(all / float(count), 0.5)).rgb, 1.0);
  shown = sum;)"})})](int frame) {
              scene->program.use();
              scene->program.set("mode", std::min(frame / 7, 3));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
