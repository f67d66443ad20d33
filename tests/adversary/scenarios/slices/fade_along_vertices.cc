// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario fade_along_vertices() {
  return {.sentence = "A second output of the vertex shader fades opacity towards the volume's faces.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(
                        canvas, {.fragment = slice_fragment_shader("in float fade;", "  colour.a *= fade;"),
                                 .vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
out float fade;
void main() {
  at = position;
  fade = 1.0 - 0.8 * position.x * position.z;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
