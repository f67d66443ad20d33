// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lighting_guarded() {
  return {.sentence = "Diffuse light only where the gradient is steep enough for a direction.",
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
  vec3 g = slope(here);
  if (length(g) > 0.05) colour.rgb *= 0.2 + 0.8 * abs(dot(normalize(g), normalize(vec3(1.0, 2.0, 1.5))));)")});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
