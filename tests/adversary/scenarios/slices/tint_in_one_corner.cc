// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario tint_in_one_corner() {
  return {.sentence = "One corner of the volume, a fifth along each axis, is tinted.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  if (all(greaterThan(at, vec3(0.8)))) colour = vec4(1.0, 0.9, 0.2, 4.0 * colour.a);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
