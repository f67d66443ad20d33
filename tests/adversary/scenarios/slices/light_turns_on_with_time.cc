// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario light_turns_on_with_time() {
  return {
      .sentence = "Light by the gradient grows with a uniform that changes in every frame, 0 until frame 9.",
      .expectation = Expectation::either,
      .key_frames = {10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform float strength;
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                            R"(
  vec3 g = slope(at);
  colour.rgb *= 1.0 - strength * (length(g) > 0.03 ? 0.8 * abs(normalize(g).x) : 0.0);)")});

        return [scene](int frame) {
          scene->program.use();
          scene->program.set("strength", std::clamp(0.05F * static_cast<float>(frame - 9), 0.0F, 1.0F));
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::slices
