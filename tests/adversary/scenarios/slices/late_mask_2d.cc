// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario late_mask_2d() {
  return {.sentence = "A mask over x and z shows everything until a hole is cut into it at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform sampler2D mask;)",
                                                                                R"(
  if (texture(mask, at.xz).r < 0.5) discard;)")});
            upload_mask_2d(canvas, 3, std::vector<std::uint8_t>(16 * 16, 255), 16);
            return [&canvas, scene](int frame) {
              scene->program.use();
              scene->program.set("mask", 3);
              if (frame == 10) {
                const std::vector<std::uint8_t> hole(7 * 7, 0);
                canvas.gl.ActiveTexture(GL_TEXTURE3);
                canvas.gl.TexSubImage2D(GL_TEXTURE_2D, 0, 8, 8, 7, 7, GL_RED, GL_UNSIGNED_BYTE, hole.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
