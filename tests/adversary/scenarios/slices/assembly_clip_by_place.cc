// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_clip_by_place() {
  return {.sentence =
              "A program in assembly hides samples below a plane in z, which is in program.local[0]. "
              "The plane moves into the volume at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = assembly_slices({.instructions = R"(TEMP value, colour, kept;
TEX value, fragment.texcoord[0], texture[0], 3D;
TEX colour, value, texture[1], 1D;
SGE kept.x, fragment.texcoord[0].z, program.local[0].x;
MUL result.color, colour, kept.x;
)",
                                    .local = [](int frame) {
                                      return Parameter{frame < 10 ? -1.0F : 0.3F, 0, 0, 0};
                                    }})};
}

}  // namespace adversary::slices
