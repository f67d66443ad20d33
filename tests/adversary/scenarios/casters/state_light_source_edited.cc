// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::casters {

Scenario state_light_source_edited() {
  return {.sentence =
              "GLSL 1.20: a ray takes its samples times gl_LightSource[0].diffuse, which turns from white to "
              "green at frame 10, while the camera stands still.",
          .expectation = Expectation::must_be_substituted,
          .key_frames = {10},
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
    colour.rgb *= gl_LightSource[0].diffuse.rgb;
    sum += (1.0 - sum.a) * vec4(colour.rgb * colour.a, colour.a);
  }
  gl_FragColor = sum;
}
)");
            upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::luminance});
            upload_table_1d(canvas, 1, soft_colours());
            return [&canvas, program](int frame) {
              const Camera camera = old_camera(canvas, 0);
              begin_old_frame(canvas, camera);
              program.use();
              program.set("volume", 0);
              program.set("table", 1);
              program.set("eye", camera.eye);
              const std::array<GLfloat, 4> light{frame < 10 ? 1.0F : 0.3F, 1, frame < 10 ? 1.0F : 0.4F, 1};
              if (frame == 0 || frame == 10) canvas.gl.Lightfv(GL_LIGHT0, GL_DIFFUSE, light.data());
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
