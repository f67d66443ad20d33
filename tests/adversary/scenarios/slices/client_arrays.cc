// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario client_arrays() {
  return {.sentence = "Fixed function: slices from vertex arrays in the program's own memory.",
          .expectation = Expectation::must_be_substituted,
          .profile = Profile::compatibility,
          .start = [](Canvas& canvas) -> DrawFrame {
            upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
            return [&canvas](int frame) {
              const Gl& gl = canvas.gl;
              const Camera camera = old_camera(canvas, frame);
              begin_old_frame(canvas, camera);
              gl.Enable(GL_TEXTURE_3D);
              gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
              set_blending(gl, Blending::over);
              const std::vector<Vector> corners = triangles(view_aligned_slices(camera, 64));
              gl.EnableClientState(GL_VERTEX_ARRAY);
              gl.EnableClientState(GL_TEXTURE_COORD_ARRAY);
              gl.VertexPointer(3, GL_FLOAT, sizeof(Vector), corners.data());
              gl.TexCoordPointer(3, GL_FLOAT, sizeof(Vector), corners.data());
              gl.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
              gl.DisableClientState(GL_VERTEX_ARRAY);
              gl.DisableClientState(GL_TEXTURE_COORD_ARRAY);
            };
          }};
}

}  // namespace adversary::slices
