// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario layer_drawn_into_volume() {
  return {.sentence = "From frame 10 on, the program clears layers of its volume, as framebuffers.",
          .expectation = Expectation::either,
          .key_frames = {10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
)")});
            GLuint framebuffer = 0;
            canvas.gl.GenFramebuffers(1, &framebuffer);
            return [&canvas, scene, framebuffer](int frame) {
              scene->program.use();
              if (frame >= 10) {
                constexpr std::array<GLfloat, 4> high{0.9F, 0, 0, 1};
                canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
                canvas.gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, scene->volume, 0,
                                                  frame);
                canvas.gl.ClearBufferfv(GL_COLOR, 0, high.data());
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
