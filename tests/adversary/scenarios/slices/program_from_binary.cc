// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario program_from_binary() {
  return {
      .sentence =
          "From frame 10 on, a program that tints by place, loaded from a binary where the driver gives one.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        auto plain = slice_scene(canvas);
        auto tinting = slice_scene(canvas, {.fragment = slice_fragment_shader("", "  colour.rgb *= at.zxy;")});
        GLint formats = 0, bytes = 0;
        gl.GetIntegerv(GL_NUM_PROGRAM_BINARY_FORMATS, &formats);
        if (formats > 0) gl.GetProgramiv(tinting->program.name(), GL_PROGRAM_BINARY_LENGTH, &bytes);
        if (bytes > 0) {
          std::vector<char> binary(static_cast<std::size_t>(bytes));
          GLenum format = 0;
          gl.GetProgramBinary(tinting->program.name(), bytes, nullptr, &format, binary.data());
          gl.ProgramBinary(tinting->program.name(), format, binary.data(), bytes);
          tinting->program.use();
          tinting->program.set("volume", 0);
          tinting->program.set("table", 1);
        }
        return [plain, tinting](int frame) { (frame < 10 ? plain : tinting)->draw(frame); };
      }};
}

}  // namespace adversary::slices
