// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario surface_lit() {
  return {.sentence = "A lit surface where values first pass a threshold, which is edited at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = caster_scene(canvas,
                                         {.fragment = caster_fragment_shader({.declarations = R"(
uniform float threshold;
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                              .before = "  shown = vec4(0.0);",
                                                                              .each = R"(
    if (value > threshold) {
      float light = abs(dot(normalize(slope(here) + 1e-5), normalize(vec3(1.0, 2.0, 1.5))));
      shown = vec4(vec3(0.9, 0.7, 0.5) * (0.2 + 0.8 * light), 1.0);
      break;
    })"})})](int frame) {
              scene->program.use();
              scene->program.set("threshold", frame < 10 ? 0.6F : 0.5F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
