// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario brightness_in_block() {
  return {.sentence = "Brightness lies in a uniform block, which is mapped and changed at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.fragment = slice_fragment_shader(R"(
layout(std140) uniform Look { float brightness; };)",
                                                                                R"(
  colour.rgb *= brightness;)")});
            constexpr float brightness = 1;
            GLuint block = 0;
            canvas.gl.GenBuffers(1, &block);
            canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 2, block);
            canvas.gl.BufferData(GL_UNIFORM_BUFFER, sizeof(float), &brightness, GL_DYNAMIC_DRAW);
            canvas.gl.UniformBlockBinding(scene->program.name(),
                                          canvas.gl.GetUniformBlockIndex(scene->program.name(), "Look"), 2);
            return [&canvas, scene](int frame) {
              scene->program.use();
              if (frame == 10) {
                auto* mapped = static_cast<float*>(
                    canvas.gl.MapBufferRange(GL_UNIFORM_BUFFER, 0, sizeof(float), GL_MAP_WRITE_BIT));
                *mapped = 0.4F;
                canvas.gl.UnmapBuffer(GL_UNIFORM_BUFFER);
              }
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
