// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario vertices_count_in_storage() {
  return {
      .sentence = "Every vertex adds one to a number in a shader storage buffer, which is read in every frame.",
      .expectation = Expectation::must_be_left,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(canvas, {.vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_object;
layout(std430, binding = 3) buffer Counter { uint vertices; };
out vec3 at;
void main() {
  atomicAdd(vertices, 1u);
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"});
        constexpr GLuint zero = 0;
        GLuint buffer = 0;
        canvas.gl.GenBuffers(1, &buffer);
        canvas.gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffer);
        canvas.gl.BufferData(GL_SHADER_STORAGE_BUFFER, sizeof(zero), &zero, GL_DYNAMIC_COPY);
        return [&canvas, scene](int frame) {
          scene->draw(frame);
          GLuint vertices = 0;
          canvas.gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
          canvas.gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof(vertices), &vertices);
          canvas.note(std::to_string(vertices));
        };
      }};
}

}  // namespace adversary::casters
