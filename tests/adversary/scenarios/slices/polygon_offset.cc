// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario polygon_offset() {
  return {
      .sentence =
          "An opaque triangle stands in the volume. The camera stands still. From frame 10 on, a polygon "
          "offset puts all slices behind the triangle.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        auto opaque = std::make_shared<GlslProgram>(canvas, slice_vertex_shader, R"(#version 330 core
in vec3 at;
out vec4 colour;
void main() { colour = vec4(at.x, 0.4, at.y, 1.0); }
)");
        auto scene = slice_scene(canvas, {.orbit = {.degrees_each_frame = 0}});
        canvas.gl.PolygonOffset(0, 4e6F);
        return [&canvas, opaque, scene](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.1F, 0.12F, 0.2F);
          canvas.gl.Disable(GL_BLEND);
          canvas.gl.Enable(GL_DEPTH_TEST);
          opaque->use();
          opaque->set("clip_from_object", camera.clip_from_object());
          scene->vertices.draw(std::vector<Vector>{{0.1F, 0, 0.5F}, {0.9F, 0.1F, 0.5F}, {0.5F, 0.9F, 0.5F}});
          canvas.gl.DepthMask(GL_FALSE);
          if (frame >= 10) canvas.gl.Enable(GL_POLYGON_OFFSET_FILL);
          scene->draw_slices(camera);
          canvas.gl.Disable(GL_POLYGON_OFFSET_FILL);
          canvas.gl.DepthMask(GL_TRUE);
        };
      }};
}

}  // namespace adversary::slices
