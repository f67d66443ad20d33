// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario lit_from_the_eye() {
  return {.sentence = "Diffuse and specular light from the eye, by central differences of a texel.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
vec3 slope(vec3 p) {
  const float d = 1.0 / 96.0;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  vec3 g = slope(here);
  float facing = length(g) > 0.0 ? abs(dot(normalize(g), direction)) : 0.0;
  colour.rgb = colour.rgb * (0.3 + 0.5 * facing) + 0.2 * pow(facing, 12.0);)"),
                                               .grid = sampled(96, waves)});
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::casters
