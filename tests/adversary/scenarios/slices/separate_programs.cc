// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "tests/adversary/scenario.h"
#include "tests/adversary/slice_scene.h"

namespace adversary::slices {

Scenario separate_programs() {
  return {
      .sentence = "A pipeline of two separate programs, of which the fragment one is exchanged at frame 10.",
      .expectation = Expectation::either,
      .key_frames = {10},
      .start = [](Canvas& canvas) -> DrawFrame {
        const Gl& gl = canvas.gl;
        const std::string vertex = R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 0) uniform mat4 clip_from_object;
layout(location = 0) out vec3 at;
out gl_PerVertex { vec4 gl_Position; };
void main() {
  at = position;
  gl_Position = clip_from_object * vec4(position, 1.0);
}
)";
        const auto fragment = [](const std::string& look) {
          return R"(#version 430 core
layout(binding = 0) uniform sampler3D volume;
layout(binding = 1) uniform sampler2D table;
layout(location = 0) in vec3 at;
layout(location = 0) out vec4 colour;
void main() {
  colour = texture(table, vec2(texture(volume, at).r, 0.5));
)" + look + "}\n";
        };
        const auto separate = [&](GLenum stage, const std::string& text) {
          const char* words = text.c_str();
          return gl.CreateShaderProgramv(stage, 1, &words);
        };
        const GLuint vertices = separate(GL_VERTEX_SHADER, vertex);
        const GLuint plain = separate(GL_FRAGMENT_SHADER, fragment(""));
        const GLuint tinted = separate(GL_FRAGMENT_SHADER, fragment("  colour.rgb *= at.zxy;\n"));
        GLuint pipeline = 0;
        gl.GenProgramPipelines(1, &pipeline);
        return [&canvas, pipeline, vertices, plain, tinted, scene = slice_scene(canvas)](int frame) {
          const Camera camera = scene->camera(frame);
          const Matrix matrix = camera.clip_from_object();
          canvas.begin(0.1F, 0.12F, 0.2F);
          canvas.gl.UseProgram(0);
          canvas.gl.BindProgramPipeline(pipeline);
          canvas.gl.UseProgramStages(pipeline, GL_VERTEX_SHADER_BIT, vertices);
          canvas.gl.UseProgramStages(pipeline, GL_FRAGMENT_SHADER_BIT, frame < 10 ? plain : tinted);
          canvas.gl.ProgramUniformMatrix4fv(vertices, 0, 1, GL_FALSE, matrix.data());
          set_blending(canvas.gl, Blending::over);
          scene->vertices.draw(triangles(scene->polygons(camera)));
        };
      }};
}

}  // namespace adversary::slices
