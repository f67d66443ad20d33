// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario turns_lit_shine_and_light() {
  return {.sentence =
              "A light at the eye, whose exponent takes turns between 40 and 8. From frame 10 on, in odd "
              "frames, the "
              "light stands 25 degrees beside the eye; from frame 20 on in even frames, and 12 degrees.",
          .expectation = Expectation::either,
          .key_frames = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                         16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(
                canvas, {.fragment = over_caster("uniform float shininess;\nuniform vec3 light;", R"(
    const float h = 1.0 / 64.0;
    vec3 slope = vec3(texture(volume, here + vec3(h, 0.0, 0.0)).r - texture(volume, here - vec3(h, 0.0, 0.0)).r,
                      texture(volume, here + vec3(0.0, h, 0.0)).r - texture(volume, here - vec3(0.0, h, 0.0)).r,
                      texture(volume, here + vec3(0.0, 0.0, h)).r - texture(volume, here - vec3(0.0, 0.0, h)).r);
    vec3 normal = slope / (length(slope) + 1e-6);
    vec3 to_light = normalize(light - here);
    vec3 between = normalize(to_light - direction);
    colour.rgb = colour.rgb * (0.2 + 0.6 * abs(dot(normal, to_light))) +
                 vec3(0.5) * pow(abs(dot(normal, between)), shininess);)"),
                         .grid = sampled(64, waves),
                         .step_length = 0.02F});
            return [scene](int frame) {
              const bool even = frame % 2 == 0;
              float aside = 0;
              if (!even && frame >= 10 && frame < 20) aside = 25;
              if (even && frame >= 20) aside = 12;
              Orbit of_light = scene->settings.orbit;
              of_light.azimuth += aside;
              scene->program.use();
              scene->program.set("shininess", even ? 40.0F : 8.0F);
              scene->program.set("light", camera_at(of_light, frame).eye);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
