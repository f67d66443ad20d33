// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario colours_per_voxel() {
  return {.sentence = "Colours with opacity per voxel in OpenGL 3.3 core.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(
                        canvas, {.fragment = slice_fragment_shader("", "  colour = texture(volume, at);"),
                                 .grid = coloured(sampled(48, waves)),
                                 .format = {.shown = Shown::colour}})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
