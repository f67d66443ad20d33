// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_discard_by_place() {
  return {.sentence =
              "A program in assembly discards fragments (KIL) above a height in the window, which is "
              "in program.local[0]. The height moves into the window at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = assembly_slices({.instructions = R"(TEMP value, colour, kept;
TEX value, fragment.texcoord[0], texture[0], 3D;
TEX colour, value, texture[1], 1D;
SUB kept, program.local[0].x, fragment.position.y;
KIL kept;
MOV result.color, colour;
)",
                                    .local = [](int frame) {
                                      return Parameter{frame < 10 ? 1000.0F : 90.0F, 0, 0, 0};
                                    }})};
}

}  // namespace adversary::slices
