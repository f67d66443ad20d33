// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario two_plain_programs_in_turn() {
  return {.sentence = "Even frames are drawn through one table, odd ones by another program through another.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto one = caster_scene(canvas);
            auto other = caster_scene(canvas, {.fragment = over_caster("", "  colour.rgb = colour.gbr;"),
                                               .grid = sampled(48, shells),
                                               .table = other_colours()});
            return [&canvas, one, other](int frame) {
              const auto& scene = frame % 2 == 0 ? one : other;
              canvas.gl.ActiveTexture(GL_TEXTURE1);
              canvas.gl.BindTexture(GL_TEXTURE_2D, scene->table);
              canvas.gl.ActiveTexture(GL_TEXTURE0);
              canvas.gl.BindTexture(GL_TEXTURE_3D, scene->volume);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
