// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario two_programs_in_turn() {
  return {.sentence = "Even frames are drawn by a plain program, odd ones by one that tints by place.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto plain = caster_scene(canvas);
            auto tinting = caster_scene(canvas, {.fragment = over_caster("", "  colour.rgb *= here.zxy;")});
            return [plain, tinting](int frame) { (frame % 2 == 0 ? plain : tinting)->draw(frame); };
          }};
}

}  // namespace adversary::casters
