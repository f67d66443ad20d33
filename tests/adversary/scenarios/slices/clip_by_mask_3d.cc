// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_by_mask_3d() {
  return {.sentence = "A second volume tells what shows; a corner of it is cleared at frame 14.",
          .expectation = Expectation::either,
          .key_frames = {14},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform sampler3D mask;)",
                                                                                R"(
  if (texture(mask, at).r < 0.5) discard;)")});
            upload_volume(canvas, 3,
                          sampled(16, [](float x, float y,
                                         float z) { return x * x + y * y > 0.2F || z < 0.3F ? 1.0F : 0.0F; }),
                          {.filter = GL_NEAREST});
            return [&canvas, scene](int frame) {
              scene->program.use();
              scene->program.set("mask", 3);
              canvas.gl.ActiveTexture(GL_TEXTURE3);
              if (frame == 14) replace_texels(canvas, scaled(sampled(8, waves), 0), {}, 8, 8, 8);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
