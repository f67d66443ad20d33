// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario channels_changed() {
  return {
      .sentence = "What the texture hands out as green is its value, and from frame 10 on one, by a swizzle.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                   R"(
  colour = texture(table, vec2(texture(volume, here).g, 0.5));)")});

        return [&canvas, scene](int frame) {
          scene->program.use();
          canvas.gl.ActiveTexture(GL_TEXTURE0);
          canvas.gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_SWIZZLE_G, frame < 10 ? GL_RED : GL_ONE);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
