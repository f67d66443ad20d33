// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_window_edited() {
  return {.sentence =
              "A program in assembly maps samples by a window in program.local[0] before the table "
              "look-up, and multiplies by program.env[0]. Each changes twice.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {8, 13, 18, 23},
          .profile = Profile::compatibility,
          .start = assembly_slices(
              {.instructions = R"(TEMP value, colour;
TEX value, fragment.texcoord[0], texture[0], 3D;
MAD_SAT value.x, value.x, program.local[0].x, program.local[0].y;
TEX colour, value.x, texture[1], 1D;
MUL result.color, colour, program.env[0];
)",
               .local =
                   [](int frame) {
                     if (frame < 8) return Parameter{1, 0, 0, 0};
                     return frame < 18 ? Parameter{1.6F, -0.3F, 0, 0} : Parameter{0.7F, 0.2F, 0, 0};
                   },
               .environment =
                   [](int frame) {
                     if (frame < 13) return Parameter{1, 1, 1, 1};
                     return frame < 23 ? Parameter{0.2F, 1, 0.6F, 1} : Parameter{1, 0.3F, 0.2F, 0.8F};
                   }})};
}

}  // namespace adversary::slices
