// SPDX-License-Identifier: Apache-2.0
// Draws under state that Understudy's drawing must respect and preserve: primitive restart, lines among the
// slices, the application's transform feedback.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "drawing.h"
#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

constexpr const char* vertex_shader =
    "#version 120\n"
    "varying vec3 place;\n"
    "void main() {\n"
    "  place = gl_Vertex.xyz + 0.5;\n"
    "  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;\n"
    "}\n";
constexpr const char* fragment_shader =
    "#version 120\n"
    "uniform sampler3D field;\n"
    "varying vec3 place;\n"
    "void main() { gl_FragColor = texture3D(field, place); }\n";

class SurroundingCalls : public ::testing::Test {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    load_colours(*app_);
  }

  template <class Draw>
  std::vector<float> frame(bool under, const Draw& draw) {
    app_->use_chain(under);
    app_->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app_->gl().ClearColor(0.1F, 0.2F, 0.3F, 1);
    app_->gl().Clear(GL_COLOR_BUFFER_BIT);
    look(*app_, View::perspective, 25);
    app_->gl().Enable(GL_BLEND);
    app_->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    draw();
    app_->gl().Disable(GL_BLEND);
    app_->end_frame();
    return app_->read_pixels();
  }

  std::unique_ptr<GlApplication> app_;
};

/// Slices of four corners each.
std::vector<std::array<GLfloat, 3>> slice_corners(int slices) {
  std::vector<std::array<GLfloat, 3>> corners;
  for (int i = 0; i < slices; ++i) {
    const float z = (float(i) + 0.5F) / float(slices) - 0.5F;
    for (const auto& [x, y] : {std::pair{-0.5F, -0.5F}, {0.5F, -0.5F}, {-0.5F, 0.5F}, {0.5F, 0.5F}})
      corners.push_back({x, y, z});
  }
  return corners;
}

TEST_F(SurroundingCalls, PrimitiveRestartNamesNoVertexOfTheApplicationsMemory) {
  constexpr int slices = 20;
  constexpr GLushort restart = 0xffff;
  const auto corners = slice_corners(slices);
  std::vector<GLushort> indices;
  for (GLushort i = 0; i < 4 * slices; ++i) {
    if (i > 0 && i % 4 == 0) indices.push_back(restart);
    indices.push_back(i);
  }
  app_->gl().UseProgram(glsl_program(app_->gl(), vertex_shader, fragment_shader));
  const auto draw = [&] {
    app_->gl().EnableClientState(GL_VERTEX_ARRAY);
    app_->gl().VertexPointer(3, GL_FLOAT, 0, corners.data());
    app_->gl().Enable(GL_PRIMITIVE_RESTART);
    app_->gl().PrimitiveRestartIndex(restart);
    app_->gl().DrawElements(GL_TRIANGLE_STRIP, GLsizei(indices.size()), GL_UNSIGNED_SHORT, indices.data());
    app_->gl().Disable(GL_PRIMITIVE_RESTART);
    app_->gl().DisableClientState(GL_VERTEX_ARRAY);
  };
  const auto bare = frame(false, draw);
  EXPECT_NE(bare, frame(false, [] {})) << "there is nothing to be seen";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(true, draw), bare) << "frame " << i;
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(SurroundingCalls, LinesByTheVolumesProgramAreDrawnWithoutAnError) {
  const auto corners = slice_corners(20);
  app_->gl().UseProgram(glsl_program(app_->gl(), vertex_shader, fragment_shader));
  const auto draw = [&] {
    for (std::size_t i = 0; i < corners.size(); i += 4) {
      app_->gl().Begin(GL_TRIANGLE_STRIP);
      for (std::size_t k = i; k < i + 4; ++k) app_->gl().Vertex3fv(corners[k].data());
      app_->gl().End();
    }
    app_->gl().Begin(GL_LINES);
    for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
      app_->gl().Vertex3fv(corners[i].data());
      app_->gl().Vertex3fv(corners[i + 1].data());
    }
    app_->gl().End();
  };
  const auto bare = frame(false, draw);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(true, draw), bare) << "frame " << i;
  EXPECT_EQ(app_->last_reason(), "points or lines are drawn among the slices");
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

TEST_F(SurroundingCalls, TheApplicationsTransformFeedbackKeepsItsVertices) {
  constexpr const char* captured = "place";
  const DispatchTable& gl = app_->driver();
  const GLuint program = glsl_program(gl, vertex_shader, fragment_shader);
  gl.TransformFeedbackVaryings(program, 1, &captured, GL_INTERLEAVED_ATTRIBS);
  gl.LinkProgram(program);
  GLuint object = 0;
  GLuint buffer = 0;
  gl.GenTransformFeedbacks(1, &object);
  gl.BindTransformFeedback(GL_TRANSFORM_FEEDBACK, object);
  gl.GenBuffers(1, &buffer);
  gl.BindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
  gl.BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, 4096, nullptr, GL_DYNAMIC_COPY);
  gl.UseProgram(program);
  gl.BeginTransformFeedback(GL_TRIANGLES);
  gl.Begin(GL_TRIANGLES);
  for (int i = 0; i < 9; ++i) gl.Vertex3f(0.3F * float(i % 3), 0.2F * float(i % 2), 0.1F * float(i / 3));
  gl.End();
  gl.EndTransformFeedback();
  gl.UseProgram(0);

  const auto samples_of_feedback = [&] {
    GLuint query = 0;
    GLuint samples = 0;
    gl.GenQueries(1, &query);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.VertexPointer(3, GL_FLOAT, 0, nullptr);
    gl.BindBuffer(GL_ARRAY_BUFFER, 0);
    gl.EnableClientState(GL_VERTEX_ARRAY);
    gl.BeginQuery(GL_SAMPLES_PASSED, query);
    gl.DrawTransformFeedback(GL_TRIANGLES, object);
    gl.EndQuery(GL_SAMPLES_PASSED);
    gl.DisableClientState(GL_VERTEX_ARRAY);
    gl.GetQueryObjectuiv(query, GL_QUERY_RESULT, &samples);
    gl.DeleteQueries(1, &query);
    return samples;
  };
  frame(false, [&] { draw_cube(*app_); });
  const GLuint before = samples_of_feedback();
  EXPECT_GT(before, 0U);
  frame(true, [&] { draw_cube(*app_); });
  EXPECT_EQ(app_->substituted(), 1U) << app_->last_reason();
  EXPECT_EQ(samples_of_feedback(), before);
  GLint bound = 0;
  gl.GetIntegerv(GL_TRANSFORM_FEEDBACK_BINDING, &bound);
  EXPECT_EQ(GLuint(bound), object);
  gl.GetIntegeri_v(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, 0, &bound);
  EXPECT_EQ(GLuint(bound), buffer);
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
