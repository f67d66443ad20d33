// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario labels_share_depth() {
  return {
      .sentence =
          "Slices into a framebuffer object with a depth renderbuffer, which a second one for labels shares; "
          "from frame 12 on labels are drawn there over a copy of the image, tested against that depth.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        auto plain = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        auto labelled = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        GLuint depth = 0;
        gl.GenRenderbuffers(1, &depth);
        gl.BindRenderbuffer(GL_RENDERBUFFER, depth);
        gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, canvas.width(), canvas.height());
        for (const auto& offscreen : {plain, labelled}) {
          gl.BindFramebuffer(GL_FRAMEBUFFER, offscreen->framebuffer());
          gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
        }
        auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
        return [&canvas, plain, labelled, opaque, scene = slice_scene(canvas)](int frame) {
          const int width = canvas.width(), height = canvas.height();
          const Camera camera = scene->camera(frame);
          plain->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_slices(camera);
          if (frame >= 12) {
            canvas.gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, labelled->framebuffer());
            canvas.gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT,
                                      GL_NEAREST);
            canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, labelled->framebuffer());
            canvas.gl.Disable(GL_BLEND);
            opaque->use();
            opaque->set("clip_from_object", camera.clip_from_object());
            scene->vertices.draw(
                std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 1.2F}});
          }
          canvas.gl.Disable(GL_DEPTH_TEST);
          (frame >= 12 ? labelled : plain)->show();
        };
      }};
}

}  // namespace adversary::slices
