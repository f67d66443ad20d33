// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_with_both_faces() {
  return {.sentence =
              "Without blending, front and back faces in one draw, in an order that does not depend on the "
              "view: the "
              "nearer one is shown by the depth test, from frame 10 on the later one because there is none, "
              "and from "
              "frame 20 on because depth is not written.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.orbit = {.degrees_each_frame = 11}});
            return [&canvas, scene](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.3F, 0.6F, 0.5F);
              canvas.gl.Disable(GL_BLEND);
              frame / 10 == 1 ? canvas.gl.Disable(GL_DEPTH_TEST) : canvas.gl.Enable(GL_DEPTH_TEST);
              canvas.gl.DepthMask(frame < 20 ? GL_TRUE : GL_FALSE);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              scene->program.set("eye", camera.eye);
              scene->vertices.draw(box_triangles());
              canvas.gl.DepthMask(GL_TRUE);
            };
          }};
}

}  // namespace adversary::casters
