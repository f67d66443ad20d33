// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_of_second_draw_buffer() {
  return {
      .sentence =
          "At its start the program gives draw buffer 1 a colour mask and a blend function of its own. After "
          "the volume it draws over two targets at once; the right half of the window shows the second.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        GLuint framebuffer = 0;
        std::array<GLuint, 2> targets{};
        gl.GenFramebuffers(1, &framebuffer);
        gl.GenRenderbuffers(2, targets.data());
        gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        for (GLuint i = 0; i < 2; ++i) {
          gl.BindRenderbuffer(GL_RENDERBUFFER, targets[i]);
          gl.RenderbufferStorage(GL_RENDERBUFFER, canvas.colour_format(GL_RGBA8), canvas.width(),
                                 canvas.height());
          gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_RENDERBUFFER, targets[i]);
        }
        constexpr std::array<GLenum, 2> buffers{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
        gl.DrawBuffers(2, buffers.data());
        gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
        gl.ClearColor(0.2F, 0.2F, 0.2F, 1);
        gl.Clear(GL_COLOR_BUFFER_BIT);
        gl.Enable(GL_BLEND);
        gl.BlendFunci(0, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
        gl.BlendFunci(1, GL_ONE, GL_ONE);
        gl.ColorMaski(1, GL_TRUE, GL_FALSE, GL_TRUE, GL_TRUE);
        auto overlay = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() { first = second = vec4(0.3, 0.3, 0.1, 0.9); }
)");
        return [&canvas, framebuffer, overlay, scene = slice_scene(canvas)](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.1F, 0.12F, 0.2F);
          scene->program.use();
          scene->program.set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(triangles(scene->polygons(camera)));
          canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
          canvas.gl.Clear(GL_COLOR_BUFFER_BIT);
          overlay->use();
          overlay->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(box_triangles());
          canvas.gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, canvas.framebuffer());
          const int middle = canvas.width() / 2;
          canvas.gl.BlitFramebuffer(middle, 0, canvas.width(), canvas.height(), middle, 0, canvas.width(),
                                    canvas.height(), GL_COLOR_BUFFER_BIT, GL_NEAREST);
        };
      }};
}

}  // namespace adversary::slices
