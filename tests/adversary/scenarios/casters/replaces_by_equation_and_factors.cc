// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario replaces_by_equation_and_factors() {
  return {
      .sentence =
          "Blending is off; from frame 8 on it is on with ONE and ZERO, from frame 12 on with the same factors "
          "but MAX, from frame 16 on with CONSTANT_ALPHA and ZERO, from frame 20 on as over, and from frame 24 "
          "on it is off in even frames and on in odd ones.",
      .expectation = Expectation::either,
      .key_frames = {8, 12, 16, 20, 24, 25},
      .start = [](Canvas& canvas) -> DrawFrame {
        return [&canvas, scene = caster_scene(canvas)](int frame) {
          const Camera camera = scene->camera(frame);
          canvas.begin(0.5F, 0.2F, 0.45F);
          const bool off = frame < 8 || (frame >= 24 && frame % 2 == 0);
          off ? canvas.gl.Disable(GL_BLEND) : canvas.gl.Enable(GL_BLEND);
          canvas.gl.BlendEquation(frame >= 12 && frame < 16 ? GL_MAX : GL_FUNC_ADD);
          canvas.gl.BlendColor(1, 1, 1, 0.6F);
          canvas.gl.BlendFunc(frame >= 16 && frame < 20 ? GL_CONSTANT_ALPHA : GL_ONE,
                              frame >= 20 ? GL_ONE_MINUS_SRC_ALPHA : GL_ZERO);
          scene->program.use();
          scene->program.set("clip_from_object", camera.clip_from_object());
          scene->program.set("eye", camera.eye);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.CullFace(GL_BACK);
          scene->vertices.draw(box_triangles());
          canvas.gl.Disable(GL_CULL_FACE);
        };
      }};
}

}  // namespace adversary::casters
