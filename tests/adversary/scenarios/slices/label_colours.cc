// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario label_colours() {
  return {.sentence = "A volume of labels, whole numbers, tells which of three colours tints the sample.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform usampler3D labels;)",
                                                                                R"(
  uint label = texture(labels, at).r;
  colour.rgb *= label == 0u ? vec3(1.0) : label == 1u ? vec3(1.0, 0.3, 0.3) : vec3(0.3, 1.0, 0.4);)")});
            upload_labels(canvas, 3, sampled(12, [](float x, float y, float z) {
                            return x + y < 0.8F ? 0.0F : z < 0.5F ? 1.0F : 2.0F;
                          }));
            return [scene](int frame) {
              scene->program.use();
              scene->program.set("labels", 3);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
