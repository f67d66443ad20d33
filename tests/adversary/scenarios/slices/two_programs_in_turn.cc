// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario two_programs_in_turn() {
  return {.sentence = "Even frames are drawn by a plain program, odd ones by one that tints by place.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto plain = slice_scene(canvas);
            auto tinting =
                slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour.rgb *= at.zxy;")});
            return [plain, tinting](int frame) { (frame % 2 == 0 ? plain : tinting)->draw(frame); };
          }};
}

}  // namespace adversary::slices
