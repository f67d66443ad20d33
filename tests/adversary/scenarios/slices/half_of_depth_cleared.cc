// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario half_of_depth_cleared() {
  return {
      .sentence =
          "Depth is cleared by glClearBufferfv alone; after the slices that of the left half is cleared "
          "under a scissor, and from frame 9 on triangles are drawn, which slices hide in the right half only.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
        return [&canvas, opaque, scene = slice_scene(canvas)](int frame) {
          constexpr std::array<float, 4> background{0.1F, 0.12F, 0.2F, 1};
          constexpr float farthest = 1;
          const Camera camera = scene->camera(frame);
          canvas.gl.BindFramebuffer(GL_FRAMEBUFFER, canvas.framebuffer());
          canvas.gl.Viewport(0, 0, canvas.width(), canvas.height());
          canvas.gl.ClearColor(background[0], background[1], background[2], background[3]);
          canvas.gl.Clear(GL_COLOR_BUFFER_BIT);
          canvas.gl.ClearBufferfv(GL_DEPTH, 0, &farthest);
          canvas.gl.Enable(GL_DEPTH_TEST);
          scene->draw_slices(camera);
          canvas.gl.Enable(GL_SCISSOR_TEST);
          canvas.gl.Scissor(0, 0, canvas.width() / 2, canvas.height());
          canvas.gl.Clear(GL_DEPTH_BUFFER_BIT);
          canvas.gl.Disable(GL_SCISSOR_TEST);
          if (frame < 9) return;
          canvas.gl.Disable(GL_BLEND);
          opaque->use();
          opaque->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(std::vector<Vector>{{-0.2F, 0.3F, 0.4F},
                                                   {1.2F, 0.4F, 0.3F},
                                                   {0.6F, 1.3F, 1.2F},
                                                   {0.2F, -0.2F, 0.5F},
                                                   {1.3F, -0.1F, 0.2F},
                                                   {0.9F, 0.4F, 0.3F}});
        };
      }};
}

}  // namespace adversary::slices
