// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario clip_distance() {
  return {.sentence = "A clip distance of the vertex shader, by a uniform, cuts the drawing from frame 10 on.",
          .expectation = Expectation::either,
          .key_frames = {10},
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
uniform float limit;
out vec3 at;
out float gl_ClipDistance[1];
void main() {
  at = position;
  gl_ClipDistance[0] = limit - position.x;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"});
            return [&canvas, scene](int frame) {
              canvas.gl.Enable(GL_CLIP_DISTANCE0);
              scene->program.use();
              scene->program.set("limit", frame < 10 ? 2.0F : 0.7F);
              scene->draw(frame);
            };
          }};
}

}  // namespace adversary::slices
