// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario empty_then_uploaded() {
  return {.sentence = "The volume is empty until frame 8; its opacity grows along x.",
          .expectation = Expectation::either,
          .key_frames = {8},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
  colour.a *= value > 0.02 ? here.x : 0.0;)"),
                                               .grid = scaled(sampled(48, waves), 0)});
            return [&canvas, scene](int frame) {
              scene->program.use();
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              if (frame == 8) replace_texels(canvas, sampled(48, waves), scene->settings.format);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
