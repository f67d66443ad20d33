// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

namespace adversary::slices {

Scenario assembly_place_by_parameter() {
  return {.sentence =
              "A program in assembly adds program.local[0] to the place of the sample. It is zero "
              "until frame 10, then moves the samples in z.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = assembly_slices({.instructions = R"(TEMP value, place;
ADD place, fragment.texcoord[0], program.local[0];
TEX value, place, texture[0], 3D;
TEX result.color, value, texture[1], 1D;
)",
                                    .local = [](int frame) {
                                      return Parameter{0, 0, frame < 10 ? 0.0F : 0.3F, 0};
                                    }})};
}

}  // namespace adversary::slices
