// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario half_floats() {
  return {.sentence = "Texels of half floats.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
)"),
                                               .format = {.texel = Texel::half}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
