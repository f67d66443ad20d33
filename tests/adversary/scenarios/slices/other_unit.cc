// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario other_unit() {
  return {.sentence = "The sampler is pointed at another unit, with another volume, at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
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

}  // namespace adversary::slices
