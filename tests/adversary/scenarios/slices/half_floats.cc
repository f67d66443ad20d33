// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario half_floats() {
  return {.sentence = "Texels of half floats.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
)"),
                                              .format = {.texel = Texel::half}});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
