// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario constant_alpha() {
  return {.sentence = "Blended by a constant opacity, which changes at frame 10.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              canvas.gl.BlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
              canvas.gl.BlendColor(0, 0, 0, frame < 10 ? 0.1F : 0.04F);
              scene->vertices.draw(triangles(scene->polygons(camera)));
            };
          }};
}

}  // namespace adversary::slices
