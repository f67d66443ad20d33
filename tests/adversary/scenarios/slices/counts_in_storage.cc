// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/odd_tables.h"
#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario counts_in_storage() {
  return {
      .sentence =
          "Every fragment adds one to a number in a shader storage buffer, which is read in every frame.",
      .expectation = Expectation::must_be_left,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = slice_scene(
            canvas,
            {.fragment = at_version(
                 430, slice_fragment_shader("layout(std430, binding = 3) buffer Counter { uint fragments; };",
                                            "  atomicAdd(fragments, 1u);"))});
        constexpr GLuint zero = 0;
        GLuint buffer = 0;
        canvas.gl.GenBuffers(1, &buffer);
        canvas.gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffer);
        canvas.gl.BufferData(GL_SHADER_STORAGE_BUFFER, sizeof(zero), &zero, GL_DYNAMIC_COPY);
        return [&canvas, scene](int frame) {
          scene->draw(frame);
          GLuint fragments = 0;
          canvas.gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
          canvas.gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof(fragments), &fragments);
          canvas.note(std::to_string(fragments));
        };
      }};
}

}  // namespace adversary::slices
