// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_z_fixed() {
  return {.sentence = "What lies beyond z = 0.6 is cut by a constant in the shader.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  if (at.z > 0.6) discard;)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
