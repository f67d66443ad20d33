// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_window_edges() {
  return {.sentence = "From frame 10 on, a uniform darkens the window towards its corners.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float strength;)",
                                                                       R"(
  colour.rgb *= 1.0 - strength * smoothstep(110.0, 150.0, distance(gl_FragCoord.xy, vec2(128.0)));)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("strength", frame < 10 ? 0.0F : 0.8F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
