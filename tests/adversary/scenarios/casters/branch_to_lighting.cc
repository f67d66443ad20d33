// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario branch_to_lighting() {
  return {.sentence = "A uniform switches light on at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform int mode;
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  if (mode == 1) {
    vec3 g = slope(here);
    if (length(g) > 0.03) colour.rgb *= 0.2 + 0.8 * abs(dot(normalize(g), normalize(vec3(1.0, 2.0, 1.5))));
  })")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("mode", frame < 10 ? 0 : 1);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
