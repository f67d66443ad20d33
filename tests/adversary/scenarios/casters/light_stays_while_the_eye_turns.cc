// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario light_stays_while_the_eye_turns() {
  return {.sentence =
              "Light goes with the eye until frame 10, and then comes from one side, by a uniform vector that "
              "changes in every frame, as the camera does.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform vec3 light;
vec3 slope(vec3 p) {
  const float d = 1.0 / 96.0;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                       R"(
  vec3 g = slope(here);
  vec3 to_light = length(light) > 0.5 ? normalize(light) : direction;
  float facing = length(g) > 0.0 ? abs(dot(normalize(g), to_light)) : 0.0;
  colour.rgb *= 0.2 + 0.8 * facing;)"),
                                               .grid = sampled(96, waves)});
            return [scene](int frame) {
              scene->program.use();
              // A little otherwise in every frame, as a light that goes with the camera.
              const float length = frame < 10 ? 0.1F : 1.0F;
              scene->program.set("light", Vector{length, 0.01F * static_cast<float>(frame), 0.3F * length});
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
