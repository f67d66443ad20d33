// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_second_coordinate() {
  return {.sentence =
              "A program in assembly hides the slices whose second texture coordinate, which the "
              "vertices do not set one by one, is below program.local[0]. It is above from frame 10 "
              "on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = assembly_slices({.instructions = R"(TEMP value, colour, kept;
TEX value, fragment.texcoord[0], texture[0], 3D;
TEX colour, value, texture[1], 1D;
SGE kept.x, fragment.texcoord[1].x, program.local[0].x;
MUL result.color, colour, kept.x;
)",
                                    .local = [](int frame) {
                                      return Parameter{frame < 10 ? -1.0F : 0.1F, 0, 0, 0};
                                    }})};
}

}  // namespace adversary::slices
