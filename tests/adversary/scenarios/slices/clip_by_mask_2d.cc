// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_by_mask_2d() {
  return {.sentence = "A mask over x and y tells what shows; it is edited at frame 14.",
          .expectation = Expectation::either,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform sampler2D mask;)",
                                                                                R"(
  if (texture(mask, at.xy).r < 0.5) discard;)")});
            std::vector<std::uint8_t> mask(16 * 16, 255);
            for (std::size_t i = 0; i < 50; ++i) mask[i] = 0;
            upload_mask_2d(canvas, 3, mask, 16);
            return [&canvas, scene](int frame) {
              scene->program.use();
              scene->program.set("mask", 3);
              if (frame == 14) {
                const std::vector<std::uint8_t> hole(8 * 8, 0);
                canvas.gl.ActiveTexture(GL_TEXTURE3);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 4, 4, 8, 8, GL_RED, GL_UNSIGNED_BYTE, hole.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
