// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_gradient_opacity() {
  return {.sentence = "A uniform lets opacity follow the gradient, from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float strength;
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  colour.a *= mix(1.0, clamp(6.0 * length(slope(here)), 0.0, 1.0), strength);)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("strength", frame < 10 ? 0.0F : 1.0F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
