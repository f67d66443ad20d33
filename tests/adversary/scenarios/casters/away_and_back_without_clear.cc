// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario away_and_back_without_clear() {
  return {.sentence =
              "The box writes depth in a framebuffer object; an inset is drawn in another one, and back in the "
              "first, which is not cleared, triangles are tested against the depth.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto main_view = std::make_shared<Offscreen>(canvas, GL_RGBA8);
            auto inset = std::make_shared<Offscreen>(canvas, GL_RGBA8);
            for (const auto& offscreen : {main_view, inset}) {
              offscreen->attach_depth(GL_DEPTH_COMPONENT24);
            }
            auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
            return [&canvas, main_view, inset, opaque, scene = caster_scene(canvas)](int frame) {
              const int width = canvas.width(), height = canvas.height();
              const Camera camera = scene->camera(frame);
              const auto draw_triangle = [&] {
                canvas.gl.Disable(GL_BLEND);
                opaque->use();
                opaque->set("clip_from_object", camera.clip_from_object());
                scene->vertices.draw(
                    std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 1.2F}});
              };
              canvas.gl.Enable(GL_DEPTH_TEST);
              main_view->begin(0.1F, 0.12F, 0.2F, 1);
              canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
              scene->draw_box(camera);
              inset->begin(0.3F, 0.3F, 0.3F, 1);
              canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
              draw_triangle();
              canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, main_view->framebuffer());
              draw_triangle();
              canvas.gl.Disable(GL_DEPTH_TEST);
              main_view->show();
              canvas.gl.BindFramebuffer(GL_READ_FRAMEBUFFER, inset->framebuffer());
              canvas.gl.BlitFramebuffer(0, 0, width, height, 3 * width / 4, 3 * height / 4, width, height,
                                        GL_COLOR_BUFFER_BIT, GL_NEAREST);
            };
          }};
}

}  // namespace adversary::casters
