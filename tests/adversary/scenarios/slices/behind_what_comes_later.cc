// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario behind_what_comes_later() {
  return {.sentence = "Slices write depth; triangles that are drawn afterwards are hidden by them.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 1.0, at.y, 1.0); }
)");
            return [&canvas, opaque, scene = slice_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Enable(GL_DEPTH_TEST);
              scene->draw_slices(camera);
              canvas.gl.Disable(GL_BLEND);
              opaque->use();
              opaque->set("clip_from_object", camera.clip_from_object());
              scene->vertices.draw(
                  std::vector<Vector>{{-0.2F, 0.3F, 0.4F}, {1.2F, 0.4F, 0.6F}, {0.6F, 1.3F, 1.2F}});
            };
          }};
}

}  // namespace adversary::slices
