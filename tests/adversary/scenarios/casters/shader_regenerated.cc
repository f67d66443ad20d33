// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario shader_regenerated() {
  return {
      .sentence = "The program is linked again at frame 10, with a shader that tints by place.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                   R"(
)")});

        return [scene](int frame) {
          scene->program.use();
          if (frame == 10) {
            scene->program.link({{GL_VERTEX_SHADER, scene->settings.vertex},
                                 {GL_FRAGMENT_SHADER, over_caster("", "  colour.rgb *= 0.3 + 0.7 * here;")}});
            scene->program.use();
            scene->program.set("volume", 0);
            scene->program.set("table", 1);
            scene->program.set("step_length", 0.025F);
          }
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
