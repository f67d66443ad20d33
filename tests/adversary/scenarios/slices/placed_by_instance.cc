// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario placed_by_instance() {
  return {.sentence = "Instances of one quad, placed across z by their number.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = vec3(position.xy, (float(gl_InstanceID) + 0.5) / 48.0);
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
              canvas.gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, 48);
            };
          }};
}

}  // namespace adversary::slices
