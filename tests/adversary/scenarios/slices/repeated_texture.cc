// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario repeated_texture() {
  return {.sentence = "Texture coordinates run to 2 and the texture repeats.",
          .expectation = Expectation::either,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 330 core
in vec3 position;
uniform mat4 clip_from_object;
out vec3 at;
void main() {
  at = 2.0 * position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"});
            canvas.gl.ActiveTexture(GL_TEXTURE0);
            for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
              canvas.gl.TexParameteri(GL_TEXTURE_3D, name, GL_REPEAT);
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
