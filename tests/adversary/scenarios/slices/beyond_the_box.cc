// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario beyond_the_box() {
  return {.sentence = "Slices reach beyond the volume, where the texture goes on as it ends.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = 1.3 * position - 0.15;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"})](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
