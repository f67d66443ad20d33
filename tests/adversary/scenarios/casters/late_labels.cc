// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario late_labels() {
  return {.sentence = "All labels are 0 until frame 10, when a box of them becomes 1.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.fragment = over_caster(R"(
uniform usampler3D labels;)",
                                                                       R"(
  if (texture(labels, here).r == 1u) colour.rgb = colour.grb * vec3(1.0, 0.4, 0.4);)")});
            upload_labels(canvas, 3, sampled(12, [](float, float, float) { return 0.0F; }));
            return [&canvas, scene](int frame) {
              scene->program.use();
              scene->program.set("labels", 3);
              if (frame == 10) {
                const std::vector<std::uint8_t> ones(6 * 6 * 6, 1);
                canvas.gl.ActiveTexture(GL_TEXTURE3);
                canvas.gl.TexSubImage3D(GL_TEXTURE_3D, 0, 4, 4, 5, 6, 6, 6, GL_RED_INTEGER, GL_UNSIGNED_BYTE,
                                        ones.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::casters
