// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_tint_along_z() {
  return {.sentence = "A uniform mixes a tint along z in, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float strength;)",
                                                                       R"(
  colour.rgb = mix(colour.rgb, colour.rgb * vec3(1.0 - here.z, 1.0, here.z), strength);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("strength", frame < 10 ? 0.0F : 1.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
