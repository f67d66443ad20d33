// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario gradient_opacity() {
  return {.sentence = "Opacity grows with the gradient.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  colour.a *= clamp(6.0 * length(slope(here)), 0.0, 1.0);)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
