// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario clip_z_by_uniform() {
  return {.sentence = "A plane across z is dragged from frame 10 to 19.",
          .expectation = Expectation::either,
          .key_frames = {10, 11, 12, 13, 14, 15, 16, 17, 18, 19},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform float limit;)",
                                                                       R"(
  if (here.z > limit) continue;)")});
            return [scene](int frame) {
              scene->program.use();
              scene->program.set(
                  "limit", frame < 10 ? 2.0F : 0.95F - 0.03F * static_cast<float>(std::min(frame, 19) - 10));
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
