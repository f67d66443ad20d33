// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario transform_feedback() {
  return {.sentence = "The slices' corners are captured, and counted, in every frame.",
          .expectation = Expectation::must_be_left,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas);
            scene->program.link(
                {{GL_VERTEX_SHADER, scene->settings.vertex}, {GL_FRAGMENT_SHADER, scene->settings.fragment}},
                {"at"});
            scene->program.use();
            scene->program.set("volume", 0);
            scene->program.set("table", 1);
            GLuint buffer = 0, query = 0;
            canvas.gl.GenBuffers(1, &buffer);
            canvas.gl.GenQueries(1, &query);
            canvas.gl.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
            canvas.gl.BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, 1 << 17, nullptr, GL_DYNAMIC_COPY);
            return [&canvas, query, scene](int frame) {
              const Camera camera = scene->camera(frame);
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              canvas.gl.BeginQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN, query);
              canvas.gl.BeginTransformFeedback(GL_TRIANGLES);
              scene->vertices.draw(triangles(scene->polygons(camera)));
              canvas.gl.EndTransformFeedback();
              canvas.gl.EndQuery(GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN);
              GLuint written = 0;
              canvas.gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &written);
              std::array<float, 3> corner{};
              canvas.gl.GetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 36, sizeof(corner), corner.data());
              canvas.note(std::to_string(written) + " " + std::to_string(corner[0]) + " " +
                          std::to_string(corner[1]));
            };
          }};
}

}  // namespace adversary::slices
