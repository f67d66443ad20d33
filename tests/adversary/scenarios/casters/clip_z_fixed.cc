// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clip_z_fixed() {
  return {.sentence = "What lies beyond z = 0.6 is cut by a constant in the shader.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  if (here.z > 0.6) continue;)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
