// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario marks_in_a_display_list() {
  return {
      .sentence =
          "Fixed function: a display list, which enables the depth test itself, draws a triangle that slices "
          "hide; a query of its samples decides the colour of a bar.",
      .expectation = Expectation::either,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        upload_volume(canvas, 0, coloured(sampled(48, waves)), {.shown = Shown::colour});
        GLuint query = 0;
        gl.GenQueries(1, &query);
        const GLuint marks = gl.GenLists(1);
        gl.NewList(marks, GL_COMPILE);
        gl.Enable(GL_DEPTH_TEST);
        gl.Color3f(1, 0.9F, 0.2F);
        gl.Begin(GL_TRIANGLES);
        gl.Vertex3f(-0.2F, 0.3F, 0.4F);
        gl.Vertex3f(1.2F, 0.4F, 0.6F);
        gl.Vertex3f(0.6F, 1.3F, 1.2F);
        gl.End();
        gl.Disable(GL_DEPTH_TEST);
        gl.EndList();
        return [&canvas, query, marks](int frame) {
          const Camera camera = old_camera(canvas, frame);
          begin_old_frame(canvas, camera);
          canvas.gl.Enable(GL_TEXTURE_3D);
          canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
          set_blending(canvas.gl, Blending::over);
          canvas.gl.Enable(GL_DEPTH_TEST);
          draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
          canvas.gl.Disable(GL_DEPTH_TEST);
          canvas.gl.Disable(GL_BLEND);
          canvas.gl.Disable(GL_TEXTURE_3D);
          canvas.gl.BeginQuery(GL_SAMPLES_PASSED, query);
          canvas.gl.CallList(marks);
          canvas.gl.EndQuery(GL_SAMPLES_PASSED);
          GLuint samples = 0;
          canvas.gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &samples);
          const float quarter = 0.25F * static_cast<float>(canvas.width() * canvas.height());
          const float seen = std::min(1.0F, static_cast<float>(samples) / quarter);
          for (const GLenum mode : {GL_PROJECTION, GL_MODELVIEW}) {
            canvas.gl.MatrixMode(mode);
            canvas.gl.LoadMatrixf(identity.data());
          }
          canvas.gl.Color3f(seen, 1 - seen, 0.3F);
          canvas.gl.Begin(GL_POLYGON);
          canvas.gl.Vertex2f(-1, -1);
          canvas.gl.Vertex2f(1, -1);
          canvas.gl.Vertex2f(1, -0.8F);
          canvas.gl.Vertex2f(-1, -0.8F);
          canvas.gl.End();
        };
      }};
}

}  // namespace adversary::slices
