// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario occlusion_query() {
  return {.sentence = "A query counts the volume's samples in every frame.",
          .expectation = Expectation::must_be_left,
          .start = [](Canvas& canvas) -> DrawFrame {
            GLuint query = 0;
            canvas.gl.GenQueries(1, &query);
            return [&canvas, query, scene = slice_scene(canvas)](int frame) {
              canvas.gl.BeginQuery(GL_SAMPLES_PASSED, query);
              scene->draw(frame);
              canvas.gl.EndQuery(GL_SAMPLES_PASSED);
              GLuint samples = 0;
              canvas.gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &samples);
              canvas.note(std::to_string(samples));
            };
          }};
}

}  // namespace adversary::slices
