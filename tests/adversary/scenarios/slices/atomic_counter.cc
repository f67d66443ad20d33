// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario atomic_counter() {
  return {
      .sentence = "Every fragment increments an atomic counter, which is read in every frame.",
      .expectation = Expectation::must_be_left,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(
            canvas,
            {.fragment = at_version(
                 430, slice_fragment_shader("layout(binding = 0, offset = 0) uniform atomic_uint fragments;",
                                            "  atomicCounterIncrement(fragments);"))});
        constexpr GLuint zero = 0;
        GLuint buffer = 0;
        canvas.gl.GenBuffers(1, &buffer);
        canvas.gl.BindBufferBase(GL_ATOMIC_COUNTER_BUFFER, 0, buffer);
        canvas.gl.BufferData(GL_ATOMIC_COUNTER_BUFFER, sizeof(zero), &zero, GL_DYNAMIC_COPY);
        return [&canvas, scene](int frame) {
          scene->draw(frame);
          GLuint fragments = 0;
          canvas.gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
          canvas.gl.GetBufferSubData(GL_ATOMIC_COUNTER_BUFFER, 0, sizeof(fragments), &fragments);
          canvas.note(std::to_string(fragments));
        };
      }};
}

}  // namespace adversary::slices
