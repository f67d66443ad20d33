// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_table_of_other_sampler() {
  return {.sentence =
              "The table is looked up beyond its ends. Its unit has a sampler object that clamps; at frame 10 "
              "another one is bound, which mirrors.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            std::array<GLuint, 2> samplers{};
            canvas.gl.GenSamplers(2, samplers.data());
            for (int i = 0; i < 2; ++i) {
              for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
                canvas.gl.SamplerParameteri(samplers[i], name, GL_LINEAR);
              for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
                canvas.gl.SamplerParameteri(samplers[i], name, i == 0 ? GL_CLAMP_TO_EDGE : GL_MIRRORED_REPEAT);
            }
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", R"(
  colour = texture(table, vec2(3.0 * value - 1.0, 0.5));)")});
            return [&canvas, samplers, scene](int frame) {
              canvas.gl.BindSampler(1, samplers[frame < 10 ? 0 : 1]);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
