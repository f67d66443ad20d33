// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario vertices_pulled_from_storage() {
  return {.sentence = "The vertex shader scales slices by a number that it reads from a shader storage buffer.",
          .expectation = Expectation::must_be_substituted,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = slice_scene(canvas, {.vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_object;
layout(std430, binding = 3) readonly buffer Sizes { float size; };
out vec3 at;
void main() {
  at = position;
  gl_Position = clip_from_object * vec4(size * position, 1.0);
}
)"});
            constexpr float size = 0.8F;
            GLuint buffer = 0;
            canvas.gl.GenBuffers(1, &buffer);
            canvas.gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffer);
            canvas.gl.BufferData(GL_SHADER_STORAGE_BUFFER, sizeof(size), &size, GL_STATIC_DRAW);
            return [scene](int frame) { scene->draw(frame); };
          }};
}

}  // namespace adversary::slices
