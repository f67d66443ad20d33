// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario tint_along_z() {
  return {.sentence = "Colours turn from blue to orange along z.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  colour.rgb = mix(colour.rgb * vec3(0.3, 0.5, 1.0), colour.rgb * vec3(1.0, 0.6, 0.2), at.z);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
