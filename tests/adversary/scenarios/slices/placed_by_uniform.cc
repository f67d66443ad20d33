// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario placed_by_uniform() {
  return {.sentence = "One quad, drawn once for each slice across z; a uniform tells its place.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
uniform float place;
out vec3 at;
void main() {
  at = vec3(position.xy, place);
  gl_Position = clip_from_object * vec4(at, 1.0);
}
)",
                                              .orbit = {.azimuth = 10}});
            return [&canvas, scene](int frame) {
              canvas.begin(0.1F, 0.12F, 0.2F);
              scene->program.use();
              scene->program.set("clip_from_object", scene->camera(frame).clip_from_object());
              set_blending(canvas.gl, Blending::over);
              scene->vertices.fill(std::array<Vector, 4>{Vector{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
              for (int i = 0; i < 48; ++i) {
                scene->program.set("place", (static_cast<float>(i) + 0.5F) / 48);
                canvas.gl.DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
              }
            };
          }};
}

}  // namespace adversary::slices
