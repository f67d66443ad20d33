// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario arb_assembly() {
  return {.sentence = "A table look-up in ARB assembly.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            const std::string text = R"(!!ARBfp1.0
TEMP value;
TEX value, fragment.texcoord[0], texture[0], 3D;
TEX result.color, value, texture[1], 1D;
END
)";
            GLuint program = 0;
            canvas.gl.GenProgramsARB(1, &program);
            canvas.gl.BindProgramARB(GL_FRAGMENT_PROGRAM_ARB, program);
            canvas.gl.ProgramStringARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB,
                                       static_cast<GLsizei>(text.size()), text.data());
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, soft_colours());
            return [&canvas](int frame) {
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              canvas.gl.Enable(GL_FRAGMENT_PROGRAM_ARB);
              set_blending(canvas.gl, Blending::over);
              draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
            };
          }};
}

}  // namespace adversary::slices
