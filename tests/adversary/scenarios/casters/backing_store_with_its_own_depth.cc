// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario backing_store_with_its_own_depth() {
  return {
      .sentence =
          "As in a toolkit: the box writes depth in a widget's framebuffer object, whose colours are blitted "
          "to a backing store, where triangles are tested against depth of its own; nobody looks at the box's.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto widget = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        auto backing = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        for (const auto& offscreen : {widget, backing}) {
          offscreen->attach_depth(GL_DEPTH24_STENCIL8);
        }
        auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(0.5 + at.z, 0.8, 0.7, 1.0); }
)");
        return [&canvas, widget, backing, opaque, scene = caster_scene(canvas)](int frame) {
          const int width = canvas.width(), height = canvas.height();
          canvas.gl.Enable(GL_DEPTH_TEST);
          widget->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
          scene->draw_box(scene->camera(frame));
          backing->begin(0.3F, 0.3F, 0.3F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
          canvas.gl.BindFramebuffer(GL_READ_FRAMEBUFFER, widget->framebuffer());
          canvas.gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", identity);
          scene->vertices.draw(std::vector<Vector>{{-1, -1, -0.3F},
                                                   {-0.2F, -1, 0.3F},
                                                   {-1, -0.5F, -0.3F},
                                                   {-1, -1, 0.3F},
                                                   {-0.2F, -1, -0.3F},
                                                   {-0.2F, -0.5F, -0.3F}});
          canvas.gl.Disable(GL_DEPTH_TEST);
          backing->show();
        };
      }};
}

}  // namespace adversary::casters
