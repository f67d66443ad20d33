// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/old_slices.h"
#include "tests/adversary/scenario.h"

namespace adversary::slices {

Scenario fragment_program_in_pipeline() {
  return {
      .sentence =
          "Vertices of fixed function, and a program pipeline with a fragment program alone, while texturing "
          "is enabled. The program's tint is white, and another from frame 10 on. The camera stands still.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .profile = Profile::compatibility,
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        const char* const text = R"(#version 430 compatibility
layout(binding = 0) uniform sampler3D volume;
layout(location = 0) uniform vec4 tint;
void main() {
  vec4 value = texture(volume, gl_TexCoord[0].xyz);
  gl_FragColor = tint * vec4(value.rgb, 0.1 * value.a);
}
)";
        const GLuint fragments = gl.CreateShaderProgramv(GL_FRAGMENT_SHADER, 1, &text);
        GLuint pipeline = 0;
        gl.GenProgramPipelines(1, &pipeline);
        gl.UseProgramStages(pipeline, GL_FRAGMENT_SHADER_BIT, fragments);
        upload_volume(canvas, 0, sampled(48, waves), {.shown = Shown::intensity});
        return [&canvas, pipeline, fragments](int frame) {
          const Camera camera = old_camera(canvas, 0);
          begin_old_frame(canvas, camera);
          canvas.gl.ProgramUniform4f(fragments, 0, 1, frame < 10 ? 1.0F : 0.2F, 1, 1);
          canvas.gl.UseProgram(0);
          canvas.gl.BindProgramPipeline(pipeline);
          canvas.gl.Enable(GL_TEXTURE_3D);
          canvas.gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_MODULATE);
          canvas.gl.Color4f(1, 1, 1, 0.1F);
          set_blending(canvas.gl, Blending::over);
          draw_polygons(canvas.gl, view_aligned_slices(camera, 64));
        };
      }};
}

}  // namespace adversary::slices
