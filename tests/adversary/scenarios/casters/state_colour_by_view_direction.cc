// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario state_colour_by_view_direction() {
  return {
      .sentence =
          "GLSL 1.20: a ray takes its samples times the absolute value of an element of gl_ModelViewMatrix. "
          "The camera stands still until frame 10, and then turns in every frame.",
      .expectation = Expectation::either,
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const GlslProgram program(canvas, "#version 120\n" + old_vertex_shader, R"(#version 120
uniform sampler3D volume;
uniform sampler1D table;
uniform vec3 eye;
void main() {
  vec3 direction = normalize(gl_TexCoord[0].xyz - eye);
  vec3 ends = (step(0.0, direction) - gl_TexCoord[0].xyz) / direction;
  float length = min(ends.x, min(ends.y, ends.z));
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 200; ++i) {
    float gone = float(i) * 0.025;
    if (gone > length) break;
    vec4 colour = texture1D(table, texture3D(volume, gl_TexCoord[0].xyz + gone * direction).r);
    colour.rgb *= abs(gl_ModelViewMatrix[2].z);
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
  }
  gl_FragColor = sum;
}
)");
        upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
        upload_table_1d(canvas, 1, soft_colours());
        return [&canvas, program](int frame) {
          const Camera camera = old_camera(canvas, 3 * std::max(frame - 10, 0));
          begin_old_frame(canvas, camera);
          program.use();
          program.set("volume", 0);
          program.set("table", 1);
          program.set("eye", camera.eye);
          set_blending(canvas.gl, Blending::premultiplied_over);
          canvas.gl.Enable(GL_CULL_FACE);
          canvas.gl.Begin(GL_TRIANGLES);
          for (const Vector& corner : box_triangles()) {
            canvas.gl.TexCoord3f(corner.x, corner.y, corner.z);
            canvas.gl.Vertex3f(corner.x, corner.y, corner.z);
          }
          canvas.gl.End();
        };
      }};
}

}  // namespace adversary::casters
