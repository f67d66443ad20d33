// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario table_drawn_into() {
  return {.sentence = "At frame 10 the program clears a part of its table, as a framebuffer.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
)",
                                                                                R"(
)")});
            GLuint framebuffer = 0;
            canvas.gl.GenFramebuffers(1, &framebuffer);
            return [&canvas, scene, framebuffer](int frame) {
              scene->program.use();
              if (frame == 10) {
                constexpr std::array<GLfloat, 4> white{1, 1, 1, 0.3F};
                canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
                canvas.gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                               scene->table, 0);
                canvas.gl.Enable(GL_SCISSOR_TEST);
                canvas.gl.Scissor(140, 0, 40, 1);
                canvas.gl.ClearBufferfv(GL_COLOR, 0, white.data());
                canvas.gl.Disable(GL_SCISSOR_TEST);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
