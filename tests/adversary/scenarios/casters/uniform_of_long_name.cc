// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario uniform_of_long_name() {
  return {
      .sentence =
          "A tint in a uniform whose name has 300 letters. The camera stands still. From frame 10 on, the tint "
          "is another.",
      .expectation = Expectation::must_be_substituted,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const std::string name(300, 't');
        auto scene = caster_scene(
            canvas, {.fragment = over_caster("uniform float " + name + ";", "    colour.r *= " + name + ";"),
                     .orbit = {.degrees_each_frame = 0}});
        return [scene, name](int frame) {
          scene->program.use();
          scene->program.set(name, frame < 10 ? 1.0F : 0.2F);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
