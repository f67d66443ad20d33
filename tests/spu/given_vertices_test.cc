// SPDX-License-Identifier: Apache-2.0
// A run that is drawn in feedback mode from memory gives exactly what the run's own calls give.
#include "spu/volume/geometry/given_vertices.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "gl_application.h"
#include "spu/stream/plain_calls.h"
#include "spu/volume/geometry/feedback.h"

namespace understudy::spu::testing {
namespace {

using Calls = std::function<void(Run&)>;
using State = std::function<void(const DispatchTable&)>;

/// Polygons of kind `mode`, tilted against each other, some of them outside the view.
void append_polygons(Run& run, GLenum mode) {
  Records& calls = run.calls();
  append_call(calls, &DispatchTable::Begin, mode);
  for (int i = 0; i < 24; ++i) {
    const auto turn = float(i);
    append_call(calls, &DispatchTable::Color4f, 0.5F, turn / 24, 0.25F, 0.5F);
    append_call(calls, &DispatchTable::Normal3f, 0.1F * turn, 1.0F, 0.3F);
    append_call(calls, &DispatchTable::TexCoord3f, 0.37F * turn, 1.0F / (1 + turn), 0.7F);
    append_call(calls, &DispatchTable::Vertex3f, std::sin(turn) * 1.4F, std::cos(1.3F * turn) * 1.2F,
                0.03F * turn - 0.4F);
  }
  append_call(calls, &DispatchTable::End);
  ++run.draws;
}

/// Every quad has corners outside all sides of the view.
void append_quads_across_the_view(Run& run) {
  Records& calls = run.calls();
  append_call(calls, &DispatchTable::Begin, GL_QUADS);
  for (int i = 0; i < 8; ++i) {
    for (int corner = 0; corner < 4; ++corner) {
      const float angle = 0.3F * float(i) + float(M_PI_2) * float(corner);
      append_call(calls, &DispatchTable::Vertex3f, 2 * std::cos(angle), 2 * std::sin(angle),
                  0.1F * float(i) - 0.4F);
    }
  }
  append_call(calls, &DispatchTable::End);
  ++run.draws;
}

GLint state_of(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

Calls polygons(GLenum mode) {
  return [mode](Run& run) { append_polygons(run, mode); };
}

struct Case {
  const char* what;
  Calls calls;
  State state = [](const DispatchTable&) {};
  bool stack = false;
};

std::vector<Case> all_cases() {
  std::vector<Case> cases = {
      {.what = "triangles", .calls = polygons(GL_TRIANGLES)},
      {.what = "a strip", .calls = polygons(GL_TRIANGLE_STRIP)},
      {.what = "a fan", .calls = polygons(GL_TRIANGLE_FAN)},
      {.what = "quads", .calls = polygons(GL_QUADS)},
      {.what = "a strip of quads", .calls = polygons(GL_QUAD_STRIP)},
      {.what = "a polygon", .calls = polygons(GL_POLYGON)},
      {.what = "generated coordinates",
       .calls = polygons(GL_QUADS),
       .state =
           [](const DispatchTable& gl) {
             gl.TexGeni(GL_S, GL_TEXTURE_GEN_MODE, GL_SPHERE_MAP);
             gl.Enable(GL_TEXTURE_GEN_S);
             gl.MatrixMode(GL_TEXTURE);
             gl.Rotatef(30, 1, 1, 0);
           }},
      {.what = "light and a clip plane",
       .calls = polygons(GL_QUADS),
       .state =
           [](const DispatchTable& gl) {
             gl.Enable(GL_LIGHTING);
             gl.Enable(GL_LIGHT0);
             gl.Enable(GL_COLOR_MATERIAL);
             const std::array<GLdouble, 4> plane{1, 0.5, 0, 0.2};
             gl.ClipPlane(GL_CLIP_PLANE0, plane.data());
             gl.Enable(GL_CLIP_PLANE0);
           }},
      {.what = "flat colours",
       .calls = polygons(GL_QUADS),
       .state = [](const DispatchTable& gl) { gl.ShadeModel(GL_FLAT); }},
      {.what = "culled faces",
       .calls = polygons(GL_TRIANGLES),
       .state = [](const DispatchTable& gl) { gl.Enable(GL_CULL_FACE); }},
  };
  cases.push_back({.what = "slices of a stack",
                   .calls =
                       [](Run& run) {
                         append_polygons(run, GL_QUADS);
                         for (GLuint texture = 2; texture < 5; ++texture) {
                           run.bind_slice(texture);
                           append_polygons(run, GL_QUADS);
                         }
                       },
                   .stack = true});
  return cases;
}

/// Feedback of the run, drawn from memory or by its own calls.
ObservedPolygons observed(const GlContext& context, const Case& tried, bool from_memory) {
  Records calls;
  Pipeline pipeline;
  pipeline.stack = tried.stack;
  pipeline.volume.texture = 1;
  Run run(pipeline, calls, false);
  tried.calls(run);
  run.only_polygons = from_memory;
  GivenVertices given(context);
  return observe_by_feedback(context, run, given);
}

bool same(const ObservedPolygons& one, const ObservedPolygons& other) {
  return one.first == other.first && one.constant_colour == other.constant_colour &&
         one.vertices.size() == other.vertices.size() &&
         std::memcmp(one.vertices.data(), other.vertices.data(),
                     one.vertices.size() * sizeof(ObservedVertex)) == 0;
}

TEST(GivenVertices, AreObservedAsTheRunsOwnCallsAre) {
  for (const Case& tried : all_cases()) {
    SCOPED_TRACE(tried.what);
    const auto application = GlApplication::start(Profile::compatibility);
    if (!application) GTEST_SKIP() << "no EGL with a compatibility context";
    const GlContext context = describe_context(application->driver());
    tried.state(application->driver());
    const ObservedPolygons by_calls = observed(context, tried, false);
    EXPECT_GT(by_calls.count(), 0U);
    EXPECT_TRUE(same(by_calls, observed(context, tried, true)));
    EXPECT_EQ(application->error(), GLenum(GL_NO_ERROR));
  }
}

TEST(Feedback, TellsTheColourOfPolygonsThatAreShadedFlatAndClipped) {
  const auto application = GlApplication::start(Profile::compatibility);
  ASSERT_NE(application, nullptr) << "no EGL with a compatibility context";
  const GlContext context = describe_context(application->driver());
  application->driver().ShadeModel(GL_FLAT);
  const Case one_colour{.what = "flat quads of one colour", .calls = [](understudy::spu::Run& run) {
                          append_call(run.calls(), &DispatchTable::Color4f, 0.5F, 0.75F, 0.25F, 1.0F);
                          append_quads_across_the_view(run);
                        }};
  for (const bool from_memory : {false, true}) {
    const ObservedPolygons polygons = observed(context, one_colour, from_memory);
    EXPECT_GT(polygons.count(), 0U);
    EXPECT_EQ(polygons.constant_colour, (std::array{0.5F, 0.75F, 0.25F, 1.0F}));
  }
  EXPECT_EQ(state_of(application->driver(), GL_SHADE_MODEL), GL_FLAT);
}

TEST(GivenVertices, LeaveTheArraysAndAttributesOfTheApplication) {
  const auto application = GlApplication::start(Profile::compatibility);
  if (!application) GTEST_SKIP() << "no EGL with a compatibility context";
  const DispatchTable& gl = application->driver();
  const GlContext context = describe_context(gl);
  GLuint vertex_array = 0;
  GLuint buffer = 0;
  gl.GenVertexArrays(1, &vertex_array);
  gl.GenBuffers(1, &buffer);
  const std::array<float, 4> own{};
  gl.EnableClientState(GL_VERTEX_ARRAY);
  gl.VertexPointer(4, GL_FLOAT, 0, own.data());
  gl.ClientActiveTexture(GL_TEXTURE1);
  gl.EnableClientState(GL_TEXTURE_COORD_ARRAY);
  gl.BindVertexArray(vertex_array);
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer);

  EXPECT_GT(observed(context, all_cases().front(), true).count(), 0U);
  GLint now = 0;
  gl.GetIntegerv(GL_VERTEX_ARRAY_BINDING, &now);
  EXPECT_EQ(GLuint(now), vertex_array);
  gl.GetIntegerv(GL_ARRAY_BUFFER_BINDING, &now);
  EXPECT_EQ(GLuint(now), buffer);
  gl.GetIntegerv(GL_CLIENT_ACTIVE_TEXTURE, &now);
  EXPECT_EQ(now, GL_TEXTURE1);
  std::array<float, 4> colour{};
  gl.GetFloatv(GL_CURRENT_COLOR, colour.data());
  EXPECT_EQ(colour, (std::array{0.5F, 23.F / 24, 0.25F, 0.5F})) << "is the last of the run";
  gl.BindVertexArray(0);
  EXPECT_TRUE(gl.IsEnabled(GL_VERTEX_ARRAY));
  EXPECT_FALSE(gl.IsEnabled(GL_COLOR_ARRAY));
  EXPECT_TRUE(gl.IsEnabled(GL_TEXTURE_COORD_ARRAY));
  void* pointer = nullptr;
  gl.GetPointerv(GL_VERTEX_ARRAY_POINTER, &pointer);
  EXPECT_EQ(pointer, own.data());
  EXPECT_EQ(application->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
