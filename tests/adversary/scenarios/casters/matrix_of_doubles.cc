// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario matrix_of_doubles() {
  return {
      .sentence =
          "The last column of a matrix of doubles tints the samples. The camera stands still. From frame 10 "
          "on, the tint is another.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = at_version(
                         430, over_caster("uniform dmat4 window;", "    colour.rgb *= vec3(window[3].xyz);")),
                     .orbit = {.degrees_each_frame = 0}});
        return [&canvas, scene](int frame) {
          std::array<double, 16> window{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, frame < 10 ? 1 : 0.3, 1, 1};
          scene->program.use();
          canvas.gl.UniformMatrix4dv(scene->program.location("window"), 1, GL_FALSE, window.data());
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
