// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario other_unit() {
  return {.sentence = "The sampler is pointed at another unit, with another volume, at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
)",
                                                                       R"(
)")});
            upload_volume(canvas, 4, sampled(48, shells));
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("volume", frame < 10 ? 0 : 4);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
