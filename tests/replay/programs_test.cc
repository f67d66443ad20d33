// SPDX-License-Identifier: Apache-2.0
// Programs and their inputs.
#include <array>
#include <cstring>
#include <string_view>

#include "replayed.h"

namespace understudy::replay_test {
namespace {

using Programs = Replayed;

class CorePrograms : public Replayed {
 protected:
  CorePrograms() : Replayed(core_context(1)) {}
};

TEST_F(Programs, SourcesInSeveralStringsAndArraysOfUniforms) {
  const std::array<const char*, 3> vertex = {
      "#version 120\n", "uniform vec2 places[6]; attribute float number;\n",
      "void main() { gl_Position = vec4(places[int(number)], 0, 1); }\n"};
  const std::array<const char*, 2> fragment = {
      "#version 120\nuniform vec4 tones[2]; uniform mat3 mix_by;THIS IS NOT READ",
      "void main() { gl_FragColor = vec4(mix_by * tones[1].rgb, 1) + tones[0]; }"};
  const std::array<GLint, 2> lengths = {GLint(std::string_view(fragment[0]).find("THIS")), -1};
  const GLuint program = gl().CreateProgram();
  const GLuint shaders[] = {gl().CreateShader(GL_VERTEX_SHADER), gl().CreateShader(GL_FRAGMENT_SHADER)};
  gl().ShaderSource(shaders[0], GLsizei(vertex.size()), vertex.data(), nullptr);
  gl().ShaderSource(shaders[1], GLsizei(fragment.size()), fragment.data(), lengths.data());
  for (const GLuint shader : shaders) {
    gl().CompileShader(shader);
    gl().AttachShader(program, shader);
    gl().DeleteShader(shader);
  }
  gl().LinkProgram(program);
  gl().UseProgram(program);
  const std::array<float, 12> places = {-0.9F, -0.9F, 0.4F, -0.7F, -0.2F, 0.5F,
                                        0.9F,  0.9F,  0,    0.9F,  0.9F,  -0.3F};
  const GLint first = gl().GetUniformLocation(program, "places");
  const GLint third = gl().GetUniformLocation(program, "places[3]");
  gl().Uniform2fv(first, 3, places.data());
  gl().Uniform2fv(third, 3, &places[6]);
  gl().Uniform4f(gl().GetUniformLocation(program, "tones[0]"), 0.1F, 0, 0, 0);
  gl().Uniform4f(gl().GetUniformLocation(program, "tones[0]") + 1, 0.2F, 0.7F, 0.9F, 0);
  const std::array<float, 9> matrix = {0, 1, 0, 1, 0, 0, 0, 0, 1};
  gl().UniformMatrix3fv(gl().GetUniformLocation(program, "mix_by"), 1, GL_TRUE, matrix.data());
  const auto number = GLuint(gl().GetAttribLocation(program, "number"));
  gl().Begin(GL_TRIANGLES);
  for (int i = 5; i >= 0; --i) {
    if (number != 0) gl().VertexAttrib1f(number, float(i));
    number != 0 ? gl().Vertex2f(0, 0) : gl().VertexAttrib1f(0, float(i));
  }
  gl().End();
  expect_same_images();
}

TEST_F(Programs, InAssembly) {
  GLuint program = 0;
  gl().GenProgramsARB(1, &program);
  gl().BindProgramARB(GL_FRAGMENT_PROGRAM_ARB, program);
  constexpr std::string_view text =
      "!!ARBfp1.0\nPARAM tone = program.env[3];\nPARAM own = program.local[1];\n"
      "MUL result.color, tone, own;\nEND\n";
  gl().ProgramStringARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB, GLsizei(text.size()),
                        text.data());
  gl().ProgramEnvParameter4fARB(GL_FRAGMENT_PROGRAM_ARB, 3, 1, 0.5F, 0.25F, 1);
  const std::array<float, 4> own = {0.9F, 0.8F, 0.4F, 1};
  gl().ProgramLocalParameter4fvARB(GL_FRAGMENT_PROGRAM_ARB, 1, own.data());
  gl().Enable(GL_FRAGMENT_PROGRAM_ARB);
  gl().Rectf(-0.7F, -0.6F, 0.5F, 0.8F);
  expect_same_images();
}

TEST_F(CorePrograms, WithUniformBlocksArraysAndTransformFeedback) {
  const char* vertex =
      "#version 330 core\nlayout(std140) uniform Place { vec4 shift; };\nin vec2 corner; out vec2 moved;\n"
      "void main() { moved = corner + shift.xy; gl_Position = vec4(moved, 0, 1); }\n";
  const char* fragment =
      "#version 330 core\nuniform float tone[3]; out vec4 colour;\n"
      "void main() { colour = vec4(tone[0], tone[1], tone[2], 1); }\n";
  const GLuint program = gl().CreateProgram();
  for (const auto& [type, text] : {std::pair(GL_VERTEX_SHADER, vertex), {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = gl().CreateShader(GLenum(type));
    gl().ShaderSource(shader, 1, &text, nullptr);
    gl().CompileShader(shader);
    gl().AttachShader(program, shader);
  }
  const char* varying = "moved";
  gl().TransformFeedbackVaryings(program, 1, &varying, GL_INTERLEAVED_ATTRIBS);
  gl().LinkProgram(program);
  gl().UseProgram(program);
  const GLuint block = gl().GetUniformBlockIndex(program, "Place");
  gl().UniformBlockBinding(program, block, 2);
  const std::array<float, 3> tones = {0.9F, 0.3F, 0.6F};
  gl().Uniform1fv(gl().GetUniformLocation(program, "tone"), 3, tones.data());
  std::array<GLuint, 3> buffers{};
  gl().GenBuffers(3, buffers.data());
  const std::array<float, 4> shift = {0.2F, -0.1F, 0, 0};
  gl().BindBufferBase(GL_UNIFORM_BUFFER, 2, buffers[0]);
  gl().BufferData(GL_UNIFORM_BUFFER, sizeof shift, shift.data(), GL_STATIC_DRAW);
  GLuint array = 0;
  gl().GenVertexArrays(1, &array);
  gl().BindVertexArray(array);
  const std::array<float, 6> corners = {-0.8F, -0.8F, 0.5F, -0.4F, -0.1F, 0.7F};
  gl().BindBuffer(GL_ARRAY_BUFFER, buffers[1]);
  gl().BufferData(GL_ARRAY_BUFFER, sizeof corners, corners.data(), GL_STATIC_DRAW);
  const auto corner = GLuint(gl().GetAttribLocation(program, "corner"));
  gl().EnableVertexAttribArray(corner);
  gl().VertexAttribPointer(corner, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl().BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers[2]);
  gl().BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, sizeof corners, nullptr, GL_STATIC_COPY);
  gl().BeginTransformFeedback(GL_TRIANGLES);
  gl().DrawArrays(GL_TRIANGLES, 0, 3);
  gl().EndTransformFeedback();
  // Draws with the captured vertices and moves them once more.
  gl().BindBuffer(GL_ARRAY_BUFFER, buffers[2]);
  gl().VertexAttribPointer(corner, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl().DrawArrays(GL_LINE_LOOP, 0, 3);
  expect_same_images();
}

}  // namespace
}  // namespace understudy::replay_test
