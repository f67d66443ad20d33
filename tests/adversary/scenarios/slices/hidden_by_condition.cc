// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario hidden_by_condition() {
  return {.sentence =
              "The volume is drawn under a condition: in frames 10 to 19 a query before it has found nothing.",
          .expectation = Expectation::either,
          .key_frames = {10, 20},
          .start = [](Canvas& canvas) -> DrawFrame {
            GLuint query = 0;
            canvas.gl.GenQueries(1, &query);
            return [&canvas, query, scene = slice_scene(canvas)](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              canvas.gl.ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
              canvas.gl.Enable(GL_SCISSOR_TEST);
              canvas.gl.Scissor(0, 0, frame / 10 == 1 ? 0 : 256, 256);
              canvas.gl.BeginQuery(GL_SAMPLES_PASSED, query);
              scene->program.use();
              scene->program.set("clip_from_object", scene->camera(frame).clip_from_object());
              scene->vertices.draw(box_triangles());
              canvas.gl.EndQuery(GL_SAMPLES_PASSED);
              canvas.gl.Disable(GL_SCISSOR_TEST);
              canvas.gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
              canvas.gl.BeginConditionalRender(query, GL_QUERY_WAIT);
              scene->draw_slices(scene->camera(frame));
              canvas.gl.EndConditionalRender();
            };
          }};
}

}  // namespace adversary::slices
