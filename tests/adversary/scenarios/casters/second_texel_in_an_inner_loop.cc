// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario second_texel_in_an_inner_loop() {
  return {
      .sentence = "A loop inside the ray's takes a second texel at an offset, which counts from frame 10 on.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float strength;)",
                                                                   R"(
    for (int n = 0; n < 3; ++n)
      colour.g = mix(colour.g, texture(volume, here + vec3(0.05 * float(n), 0.0, 0.0)).r, strength);)")});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("strength", frame < 10 ? 0.0F : 0.7F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
