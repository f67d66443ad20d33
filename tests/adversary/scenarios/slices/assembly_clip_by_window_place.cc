// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_clip_by_window_place() {
  return {.sentence =
              "A program in assembly shows only the pixels left of program.env[0]. That line moves "
              "into the window at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = assembly_slices({.instructions = R"(TEMP value, colour, kept;
TEX value, fragment.texcoord[0], texture[0], 3D;
TEX colour, value, texture[1], 1D;
SLT kept.x, fragment.position.x, program.env[0].x;
MUL result.color, colour, kept.x;
)",
                                    .environment = [](int frame) {
                                      return Parameter{frame < 10 ? 1000.0F : 90.0F, 0, 0, 0};
                                    }})};
}

}  // namespace adversary::slices
