// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/assembly_slices.h"

#include "tests/adversary/old_slices.h"

namespace adversary {

std::function<DrawFrame(Canvas&)> assembly_slices(AssemblySlices slices) {
  return [slices = std::move(slices)](Canvas& canvas) -> DrawFrame {
    const std::string text = "!!ARBfp1.0\n" + slices.instructions + "END\n";
    GLuint program = 0;
    canvas.gl.GenProgramsARB(1, &program);
    canvas.gl.BindProgramARB(GL_FRAGMENT_PROGRAM_ARB, program);
    canvas.gl.ProgramStringARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB,
                               static_cast<GLsizei>(text.size()), text.data());
    upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
    upload_table_1d(canvas, 1, soft_colours());
    return [&canvas, slices](int frame) {
      const Camera camera = old_camera(canvas, frame);
      begin_old_frame(canvas, camera);
      canvas.gl.Enable(GL_FRAGMENT_PROGRAM_ARB);
      const auto give = [&](const auto& set, const std::function<Parameter(int)>& value) {
        if (!value) return;
        const Parameter now = value(frame);
        set(GL_FRAGMENT_PROGRAM_ARB, 0, now[0], now[1], now[2], now[3]);
      };
      give(canvas.gl.ProgramLocalParameter4fARB, slices.local);
      give(canvas.gl.ProgramEnvParameter4fARB, slices.environment);
      set_blending(canvas.gl, Blending::over);
      draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
    };
  };
}

}  // namespace adversary
