// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/offscreen.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario switches_without_a_look() {
  return {
      .sentence =
          "As in a toolkit's widget: slices write depth in a framebuffer object, which is left for the window "
          "and taken again without a clear for a caption that is not tested; nobody looks at the depth.",
      .expectation = Expectation::must_be_substituted,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto offscreen = std::make_shared<Offscreen>(canvas, GL_RGBA8);
        offscreen->attach_depth(GL_DEPTH24_STENCIL8);
        auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(0.8, 0.8 + 0.2 * at.x, 0.7, 1.0); }
)");
        return [&canvas, offscreen, opaque, scene = slice_scene(canvas)](int frame) {
          offscreen->begin(0.1F, 0.12F, 0.2F, 1);
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_slices(scene->camera(frame));
          canvas.gl.Disable(GL_DEPTH_TEST);
          canvas.gl.Disable(GL_BLEND);
          canvas.begin(0.3F, 0.3F, 0.3F);
          canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, offscreen->framebuffer());
          opaque->use();
          opaque->set("clip_from_object", identity);
          scene->vertices.draw(std::vector<Vector>{{-1, -1, 0}, {0, -1, 0}, {-1, -0.7F, 0}});
          offscreen->show();
        };
      }};
}

}  // namespace adversary::slices
