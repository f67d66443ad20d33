// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario vertices_not_a_number() {
  return {.sentence = "One triangle has a corner that is not a number; drivers draw the others.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              auto corners = triangles(scene->polygons(camera));
              corners[301].x = std::numeric_limits<float>::quiet_NaN();
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              scene->vertices.draw(corners);
            };
          }};
}

}  // namespace adversary::slices
