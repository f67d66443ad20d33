// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario darker_towards_window_edges() {
  return {.sentence = "The window darkens towards its corners.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
  colour.rgb *= 1.0 - smoothstep(110.0, 180.0, distance(gl_FragCoord.xy, vec2(128.0)));)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
