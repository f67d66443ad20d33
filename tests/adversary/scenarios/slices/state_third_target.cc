// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_third_target() {
  return {.sentence =
              "Slices into a framebuffer object. From frame 10 on their draw buffers are colours, none, and "
              "marks, and the right half of the window shows the marks.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
            GLuint marks = 0;
            canvas.gl.GenRenderbuffers(1, &marks);
            canvas.gl.BindRenderbuffer(GL_RENDERBUFFER, marks);
            canvas.gl.RenderbufferStorage(GL_RENDERBUFFER, canvas.colour_format(GL_RGBA8), canvas.width(),
                                          canvas.height());
            canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, offscreen->framebuffer());
            canvas.gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT2, GL_RENDERBUFFER, marks);
            auto scene = slice_scene(canvas, {.fragment = R"(#version 330 core
uniform sampler3D volume;
uniform sampler2D table;
in vec3 at;
layout(location = 0) out vec4 colour;
layout(location = 2) out vec4 mark;
void main() {
  colour = texture(table, vec2(texture(volume, at).r, 0.5));
  mark = vec4(0.9, 0.7, 0.2, 0.05);
}
)"});
            return [&canvas, offscreen, scene](int frame) {
              offscreen->begin(0.1F, 0.12F, 0.2F, 1);
              constexpr std::array<GLenum, 3> buffers{GL_COLOR_ATTACHMENT0, GL_NONE, GL_COLOR_ATTACHMENT2};
              if (frame == 10) canvas.gl.DrawBuffers(3, buffers.data());
              if (frame == 10) canvas.gl.Clear(GL_COLOR_BUFFER_BIT);
              scene->draw_slices(scene->camera(frame));
              canvas.begin();
              canvas.gl.BindFramebuffer(GL_READ_FRAMEBUFFER, offscreen->framebuffer());
              const auto show = [&](GLenum attachment, int from, int to) {
                canvas.gl.ReadBuffer(attachment);
                canvas.gl.BlitFramebuffer(from, 0, to, canvas.height(), from, 0, to, canvas.height(),
                                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
              };
              const int middle = canvas.width() / 2;
              show(GL_COLOR_ATTACHMENT0, 0, middle);
              show(frame < 10 ? GL_COLOR_ATTACHMENT0 : GL_COLOR_ATTACHMENT2, middle, canvas.width());
            };
          }};
}

}  // namespace adversary::slices
