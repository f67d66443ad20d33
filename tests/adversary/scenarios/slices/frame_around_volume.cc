// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario frame_around_volume() {
  return {.sentence = "What lies beyond the volume is shown as a faint frame, not as the texture's edge.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            return [scene = slice_scene(canvas, {.fragment = slice_fragment_shader("", R"(
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) colour = vec4(1.0, 1.0, 1.0, 0.02);)"),
                                                 .vertex = R"(#version 330 core
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
