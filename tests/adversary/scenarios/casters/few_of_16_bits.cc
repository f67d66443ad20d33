// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario few_of_16_bits() {
  return {.sentence = "Texels of 16 bits of which 0 to 1300 are used.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  colour = texture(table, vec2(value * 65535.0 / 1300.0, 0.5));)"),
                                               .grid = scaled(sampled(48, waves), 1300.0F / 65535, 0),
                                               .format = {.texel = Texel::unsigned16}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
