// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario drawn_by_indices() {
  return {.sentence = "Slices from a vertex buffer and a buffer of indices, in one glDrawElements.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            GLuint buffer = 0;
            canvas.gl.GenBuffers(1, &buffer);
            return [&canvas, buffer, scene = slice_scene(canvas)](int frame) {
              const Camera camera = scene->camera(frame);
              std::vector<Vector> corners;
              std::vector<GLuint> indices;
              for (const Polygon& polygon : scene->polygons(camera)) {
                const auto first = static_cast<GLuint>(corners.size());
                for (GLuint i = 2; i < polygon.size(); ++i)
                  indices.insert(indices.end(), {first, first + i - 1, first + i});
                corners.insert(corners.end(), polygon.begin(), polygon.end());
              }
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", camera.clip_from_object());
              set_blending(canvas.gl, Blending::over);
              scene->vertices.fill(corners);
              canvas.gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer);
              canvas.gl.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                                   static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)), indices.data(),
                                   GL_STREAM_DRAW);
              canvas.gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT,
                                     nullptr);
            };
          }};
}

}  // namespace adversary::slices
