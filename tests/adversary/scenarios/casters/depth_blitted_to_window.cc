// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario depth_blitted_to_window() {
  return {
      .sentence =
          "The box writes depth in a framebuffer object, whose colours are blitted to the window; from frame "
          "10 on its depth is, too, and triangles are drawn in the window, tested against it.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        offscreen->attach_depth(GL_DEPTH24_STENCIL8);
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
        return [&canvas, offscreen, opaque, scene = caster_scene(canvas)](int frame) {
          const int width = canvas.width(), height = canvas.height();
          const GLbitfield depth_too = frame >= 10 ? GL_DEPTH_BUFFER_BIT : 0;
          const Camera camera = scene->camera(frame);
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_box(camera);
          canvas.begin();
          canvas.gl.BindFramebuffer(GL_READ_FRAMEBUFFER, offscreen->framebuffer());
          canvas.gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT | depth_too,
                                    GL_NEAREST);
          if (frame < 10) return;
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(
              std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 1.2F}});
        };
      }};
}

}  // namespace adversary::casters
