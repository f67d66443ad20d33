// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario tint_along_z() {
  return {.sentence = "Colours turn from blue to orange along z.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  colour.rgb = mix(colour.rgb * vec3(0.3, 0.5, 1.0), colour.rgb * vec3(1.0, 0.6, 0.2), here.z);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
