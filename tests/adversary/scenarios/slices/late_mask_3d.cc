// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario late_mask_3d() {
  return {.sentence = "A volume of masks shows everything until a hole is cut into it at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
uniform sampler3D mask;)",
                                                                                R"(
  if (texture(mask, at).r < 0.5) discard;)")});
            upload_volume(canvas, 3, sampled(16, [](float, float, float) { return 1.0F; }),
                          {.filter = GL_NEAREST});
            return [&canvas, scene](int frame) {
              scene->program.use();
              scene->program.set("mask", 3);
              canvas.gl.ActiveTexture(GL_TEXTURE3);
              if (frame == 10)
                replace_texels(canvas, sampled(8, [](float, float, float) { return 0.0F; }), {}, 8, 6, 8);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
