// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario flat_then_lit() {
  return {.sentence =
              "The volume is even until frame 10, so that light by the gradient, which is guarded, shows "
              "nothing before.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
vec3 slope(vec3 p) {
  const float d = 0.02;
  return vec3(texture(volume, p + vec3(d, 0, 0)).r - texture(volume, p - vec3(d, 0, 0)).r,
              texture(volume, p + vec3(0, d, 0)).r - texture(volume, p - vec3(0, d, 0)).r,
              texture(volume, p + vec3(0, 0, d)).r - texture(volume, p - vec3(0, 0, d)).r);
})",
                                                                                R"(
  vec3 g = slope(at);
  if (length(g) > 0.03) colour.rgb *= 0.2 + 0.8 * abs(dot(normalize(g), normalize(vec3(1.0, 2.0, 1.5))));)"),
                                              .grid = scaled(sampled(48, waves), 0, 0.6F)});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              if (frame == 10) replace_texels(canvas, sampled(48, waves), scene->settings.format);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
