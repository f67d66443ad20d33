// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_corner() {
  return {.sentence = "A uniform tints one corner of the volume, a fifth along each axis, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform bool tinted;)",
                                                                       R"(
  if (tinted && all(greaterThan(here, vec3(0.8)))) colour = vec4(1.0, 0.9, 0.2, 4.0 * colour.a);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("tinted", frame < 10 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
