// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario own_cropping_planes() {
  return {
      .sentence =
          "A tint in a uniform whose name begins as VTK's cropping planes do. The camera stands still. From "
          "frame 10 on, the tint is another.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.fragment = over_caster("uniform float in_croppingPlanesTint;",
                                                                   "    colour.r *= in_croppingPlanesTint;"),
                                           .orbit = {.degrees_each_frame = 0}});
        return [scene](int frame) {
          scene->program.use();
          scene->program.set("in_croppingPlanesTint", frame < 10 ? 1.0F : 0.2F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
