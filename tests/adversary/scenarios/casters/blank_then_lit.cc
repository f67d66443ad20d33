// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario blank_then_lit() {
  return {.sentence = "The table shows nothing until frame 10; behind it is light by the gradient, guarded.",
          .expectation = Expectation::either,
          .key_frames = {10},
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
  if (length(g) > 0.03) colour.rgb *= 0.2 + 0.8 * abs(dot(normalize(g), normalize(vec3(1.0, 2.0, 1.5))));)"),
                                               .table = std::vector<Colour>(256)});
            return [&canvas, scene](int frame) {
              scene->program.use();
              if (frame == 10) {
                const auto colours = soft_colours();
                canvas.gl.ActiveTexture(GL_TEXTURE1);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 256, 1, GL_RGBA, GL_UNSIGNED_BYTE,
                                        colours.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
