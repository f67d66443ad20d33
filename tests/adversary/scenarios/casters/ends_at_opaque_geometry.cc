// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario ends_at_opaque_geometry() {
  return {.sentence =
              "Opaque triangles stand in and before the volume; the box is tested against their depth, rays "
              "are not ended by it.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto opaque = std::make_shared<GlslProgram>(canvas, caster_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 0.4, at.y, 1.0); }
)");
            return [&canvas, opaque, scene = caster_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Disable(GL_BLEND);
              canvas.gl.Enable(GL_DEPTH_TEST);
              opaque->use();
              opaque->set("clip_from_object", camera.clip_from_object());
              scene->vertices.draw(std::vector<Vector>{{0.1F, 0, 0.4F},
                                                       {0.9F, 0.1F, 0.6F},
                                                       {0.5F, 0.7F, 0.5F},
                                                       {0.9F, 0.6F, 1.1F},
                                                       {0.6F, 1, 1.2F},
                                                       {1.2F, 1, 0.9F}});
              canvas.gl.DepthMask(GL_FALSE);
              scene->draw_box(camera);
              canvas.gl.DepthMask(GL_TRUE);
            };
          }};
}

}  // namespace adversary::casters
