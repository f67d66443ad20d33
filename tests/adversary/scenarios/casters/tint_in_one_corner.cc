// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario tint_in_one_corner() {
  return {.sentence = "One corner of the volume, a fifth along each axis, is tinted.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  if (all(greaterThan(here, vec3(0.8)))) colour = vec4(1.0, 0.9, 0.2, 4.0 * colour.a);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
