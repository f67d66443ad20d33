// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "tests/adversary/caster_scene.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario table_in_mapped_memory() {
  return {
      .sentence =
          "The table lies in a buffer that stays mapped; at frame 12 it is changed in memory, without a call.",
      .expectation = Expectation::either,
      .start = [](Canvas& canvas) -> DrawFrame {
        auto scene = caster_scene(
            canvas, {.fragment = over_caster("layout(std140) uniform Table { vec4 entries[256]; };",
                                             "    colour = entries[int(value * 255.0 + 0.5)];")});
        const std::vector<float> before = as_floats(soft_colours()), after = as_floats(other_colours());
        const auto bytes = static_cast<GLsizeiptr>(before.size() * sizeof(float));
        constexpr GLbitfield flags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
        GLuint buffer = 0;
        canvas.gl.GenBuffers(1, &buffer);
        canvas.gl.BindBufferBase(GL_UNIFORM_BUFFER, 4, buffer);
        canvas.gl.BufferStorage(GL_UNIFORM_BUFFER, bytes, before.data(), flags);
        auto* entries = static_cast<float*>(canvas.gl.MapBufferRange(GL_UNIFORM_BUFFER, 0, bytes, flags));
        canvas.gl.UniformBlockBinding(scene->program.name(),
                                      canvas.gl.GetUniformBlockIndex(scene->program.name(), "Table"), 4);
        return [scene, after, entries](int frame) {
          if (frame == 12) std::copy(after.begin(), after.end(), entries);
          scene->draw(frame);
        };
      }};
}

}  // namespace adversary::casters
