// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario signed_16() {
  return {.sentence = "Signed normalised texels of 16 bits, from -1 to 1.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  colour = texture(table, vec2(0.5 + 0.5 * value, 0.5));)"),
                                               .grid = scaled(sampled(48, waves), 2, -1),
                                               .format = {.texel = Texel::signed16}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
