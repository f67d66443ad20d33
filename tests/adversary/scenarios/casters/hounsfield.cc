// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario hounsfield() {
  return {.sentence = "Signed texels of 16 bits with what a tomograph gives: -1024 to 3071.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene =
                caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                              R"(
  colour = texture(table, vec2((value * 32767.0 + 1024.0) / 4095.0, 0.5));)"),
                                      .grid = scaled(sampled(48, waves), 4095.0F / 32767, -1024.0F / 32767),
                                      .format = {.texel = Texel::signed16}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
