// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario one_draw_each() {
  return {.sentence = "One vertex buffer, one glDrawArrays for each slice.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [&canvas, scene = slice_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              const Camera camera = scene->camera(frame);
              const auto polygons = scene->polygons(camera);
              std::vector<Vector> corners;
              for (const Polygon& polygon : polygons)
                corners.insert(corners.end(), polygon.begin(), polygon.end());
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              scene->vertices.fill(corners);
              GLint first = 0;
              for (const Polygon& polygon : polygons) {
                canvas.gl.DrawArrays(GL_TRIANGLE_FAN, first, static_cast<GLsizei>(polygon.size()));
                first += static_cast<GLint>(polygon.size());
              }
            };
          }};
}

}  // namespace adversary::slices
