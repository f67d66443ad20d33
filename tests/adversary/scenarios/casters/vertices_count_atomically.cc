// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario vertices_count_atomically() {
  return {.sentence = "Every vertex increments an atomic counter, which is read in every frame.",
          .expectation = Expectation::must_be_left,
          .start = [](Canvas& canvas) -> DrawFrame {
            auto scene = caster_scene(canvas, {.vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
uniform mat4 clip_from_object;
layout(binding = 0, offset = 0) uniform atomic_uint vertices;
out vec3 at;
void main() {
  atomicCounterIncrement(vertices);
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)"});
            constexpr GLuint zero = 0;
            GLuint buffer = 0;
            canvas.gl.GenBuffers(1, &buffer);
            canvas.gl.BindBufferBase(GL_ATOMIC_COUNTER_BUFFER, 0, buffer);
            canvas.gl.BufferData(GL_ATOMIC_COUNTER_BUFFER, sizeof(zero), &zero, GL_DYNAMIC_COPY);
            return [&canvas, scene](int frame) {
              scene->draw(frame);
              GLuint vertices = 0;
              canvas.gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
              canvas.gl.GetBufferSubData(GL_ATOMIC_COUNTER_BUFFER, 0, sizeof(vertices), &vertices);
              canvas.note(std::to_string(vertices));
            };
          }};
}

}  // namespace adversary::casters
