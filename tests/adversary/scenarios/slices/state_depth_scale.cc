// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario state_depth_scale() {
  return {.sentence =
              "Opaque triangles stand in the volume. From frame 10 on, GL_DEPTH_SCALE is a quarter, which "
              "changes what is read of depth, not what is drawn.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 0.4, at.y, 1.0); }
)");
            return [&canvas, opaque, scene = slice_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              if (frame == 10) canvas.gl.PixelTransferf(GL_DEPTH_SCALE, 0.25F);
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.Disable(GL_BLEND);
              canvas.gl.Enable(GL_DEPTH_TEST);
              opaque->use();
              opaque->set("clip_from_object", camera.clip_from_object());
              scene->vertices.draw(std::vector<Vector>{{0.1F, 0, 0.4F},
                                                       {0.9F, 0.1F, 0.6F},
                                                       {0.5F, 0.7F, 0.5F},
                                                       {0.8F, 0.5F, 0},
                                                       {0.8F, 1, 0.2F},
                                                       {0.7F, 0.6F, 1}});
              canvas.gl.DepthMask(GL_FALSE);
              scene->draw_slices(camera);
              canvas.gl.DepthMask(GL_TRUE);
            };
          }};
}

}  // namespace adversary::slices
