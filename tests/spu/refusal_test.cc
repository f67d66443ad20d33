// SPDX-License-Identifier: Apache-2.0
// What is not understood is not substituted: the image is bit-identical, and the reason is reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "slice_scenes.h"
#include "spu/volume/context/context.h"

namespace understudy::spu::testing {
namespace {

struct Refusal {
  const char* what;
  const char* reason;
  std::function<void(GlApplication&)> disturb;  ///< sets state in which no volume may be substituted
};

std::vector<Refusal> refusals() {
  return {
      {"fog by coordinates", "fog is enabled, by coordinates of the application's own",
       [](GlApplication& a) {
         a.gl().Fogi(GL_FOG_COORD_SRC, GL_FOG_COORD);
         a.gl().Enable(GL_FOG);
       }},
      {"stencil test", "the stencil test is enabled", [](GlApplication& a) { a.gl().Enable(GL_STENCIL_TEST); }},
      {"logical operation", "a logical operation is enabled",
       [](GlApplication& a) { a.gl().Enable(GL_COLOR_LOGIC_OP); }},
      {"lines", "polygons are not filled",
       [](GlApplication& a) { a.gl().PolygonMode(GL_FRONT_AND_BACK, GL_LINE); }},
      {"a subtraction", "the blend equation is a subtraction",
       [](GlApplication& a) { a.gl().BlendEquation(GL_FUNC_REVERSE_SUBTRACT); }},
      {"a subtraction of alpha", "the blend equation of alpha is a subtraction",
       [](GlApplication& a) { a.gl().BlendEquationSeparate(GL_FUNC_ADD, GL_FUNC_REVERSE_SUBTRACT); }},
      {"a depth function that keeps what is farther", "the depth function is neither LESS nor LEQUAL",
       [](GlApplication& a) {
         a.gl().Enable(GL_DEPTH_TEST);
         a.gl().DepthFunc(GL_GEQUAL);
       }},
      {"a second texture unit", "more than one texture unit takes part in fixed function",
       [](GlApplication& a) {
         a.gl().ActiveTexture(GL_TEXTURE1);
         a.gl().Enable(GL_TEXTURE_2D);
         a.gl().ActiveTexture(GL_TEXTURE0);
       }},
      {"colour sum", "a secondary colour is added after texturing",
       [](GlApplication& a) { a.gl().Enable(GL_COLOR_SUM); }},
      {"mip-mapping", "the texture is mip-mapped or filtered differently when minified",
       [](GlApplication& a) {
         a.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
       }},
      {"smoothed polygons", "polygons are smoothed",
       [](GlApplication& a) { a.gl().Enable(GL_POLYGON_SMOOTH); }},
      {"stippled polygons", "polygons are stippled",
       [](GlApplication& a) { a.gl().Enable(GL_POLYGON_STIPPLE); }},
      {"an origin at the upper left", "clip control turns or moves the view volume",
       [](GlApplication& a) { a.gl().ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE); }},
      {"conditional rendering", "the slices are rendered conditionally",
       [](GlApplication& a) {
         GLuint query = 0;
         a.gl().GenQueries(1, &query);
         a.gl().BeginQuery(GL_SAMPLES_PASSED, query);
         a.gl().EndQuery(GL_SAMPLES_PASSED);
         // No sample has passed, so nothing that follows is drawn.
         a.gl().BeginConditionalRender(query, GL_QUERY_WAIT);
       }},
      {"a query that counts primitives", "a query counts the primitives of the slices",
       [](GlApplication& a) {
         GLuint query = 0;
         a.gl().GenQueries(1, &query);
         a.gl().BeginQuery(GL_PRIMITIVES_GENERATED, query);
       }},
      {"a query of pipeline statistics", "a query counts what the slices' pipeline does",
       [](GlApplication& a) {
         GLuint query = 0;
         a.gl().GenQueries(1, &query);
         a.gl().BeginQuery(GL_FRAGMENT_SHADER_INVOCATIONS, query);
       }},
      {"an occlusion query", "an occlusion query surrounds the slices",
       [](GlApplication& a) {
         GLuint query = 0;
         a.gl().GenQueries(1, &query);
         a.gl().BeginQuery(GL_SAMPLES_PASSED, query);
       }},
  };
}

TEST(Refusals, LeaveTheApplicationsImageBitIdentical) {
  for (const Refusal& refusal : refusals()) {
    auto app = GlApplication::start(Profile::compatibility);
    if (!app) GTEST_SKIP() << "no EGL context here";
    const SliceScene scene = immediate_rgba();
    scene.set_up(*app);
    refusal.disturb(*app);
    scene.draw(*app, 20);
    const auto under = app->read_pixels();
    EXPECT_EQ(app->substituted(), 0U) << refusal.what;
    EXPECT_GE(app->left(), 1U) << refusal.what;
    EXPECT_EQ(app->last_reason(), refusal.reason) << refusal.what;
    app->use_chain(false);
    scene.draw(*app, 20);
    EXPECT_EQ(under, app->read_pixels()) << refusal.what;
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << refusal.what;
  }
}

TEST(Refusals, ShadersWhoseColourDependsOnPositionAreLeft) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  // A gradient over the volume, as lighting would give.
  const char* source =
      "#version 120\n"
      "uniform sampler3D field; uniform sampler1D table;\n"
      "void main() { gl_FragColor = texture1D(table, texture3D(field, gl_TexCoord[0].xyz).r) * "
      "gl_TexCoord[0].y; }\n";
  replace_shader(*app, GL_FRAGMENT_SHADER, source);
  scene.draw(*app, 20);
  const auto under = app->read_pixels();
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->last_reason(), "the fragment shader: colours depend on varying gl_TexCoord[0].y");
  app->use_chain(false);
  scene.draw(*app, 20);
  EXPECT_EQ(under, app->read_pixels());
}

// The shader front end supports extensions that the driver lacks; the branch that the driver compiles counts.
TEST(Refusals, AreDecidedOnTheBranchThatTheDriverCompiles) {
  const std::string by_sample = "shown = texture1D(table, texture3D(field, gl_TexCoord[0].xyz).r);\n";
  const std::string by_place = by_sample + "shown *= gl_TexCoord[0].y;\n";
  const auto shader = [](const std::string& extension, const std::string& with, const std::string& without) {
    return "#version 120\nuniform sampler3D field; uniform sampler1D table;\nvoid main() {\n  vec4 "
           "shown;\n#ifdef " +
           extension + "\n  " + with + "#else\n  " + without + "#endif\n  gl_FragColor = shown;\n}\n";
  };
  const char* const present = "GL_ARB_shader_image_load_store";
  const char* const absent = "GL_NV_mesh_shader";
  struct Case {
    std::string source;
    bool substituted;
  };
  for (const Case& each :
       {Case{shader(present, by_sample, by_place), true}, Case{shader(present, by_place, by_sample), false},
        Case{shader(absent, by_place, by_sample), true}, Case{shader(absent, by_sample, by_place), false}}) {
    auto app = GlApplication::start(Profile::compatibility);
    ASSERT_TRUE(app) << "no EGL context here";
    const std::vector<std::string> extensions = describe_context(app->driver()).extensions;
    EXPECT_THAT(extensions, ::testing::Contains(present));
    EXPECT_THAT(extensions, ::testing::Not(::testing::Contains(absent)));
    const SliceScene scene = client_arrays_table();
    scene.set_up(*app);
    replace_shader(*app, GL_FRAGMENT_SHADER, each.source.c_str());
    scene.draw(*app, 20);
    app->read_pixels();
    EXPECT_EQ(app->substituted(), each.substituted ? 1U : 0U) << each.source << app->last_reason();
    if (each.substituted) continue;
    EXPECT_EQ(app->last_reason(), "the fragment shader: colours depend on varying gl_TexCoord[0].y");
  }
}

TEST(Refusals, ASingleSliceIsLeft) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  immediate_rgba().set_up(*app);
  const auto frame = [&](bool under) {
    app->use_chain(under);
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    app->gl().Enable(GL_TEXTURE_3D);
    app->gl().Enable(GL_BLEND);
    app->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    app->gl().Begin(GL_QUADS);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      app->gl().TexCoord3d(x, y, 0.4);
      app->gl().Vertex3d(2 * x - 1, 2 * y - 1, 0);
    }
    app->gl().End();
    app->end_frame();
    return app->read_pixels();
  };
  const auto under = frame(true);
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(under, frame(false));
}

TEST(Refusals, PlainDrawingIsNeitherCountedNorChanged) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  immediate_rgba().set_up(*app);  // a 3-D texture exists, but is not used
  const auto left = app->left();
  const auto frame = [&](bool under) {
    app->use_chain(under);
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    app->gl().Enable(GL_BLEND);
    app->gl().Begin(GL_TRIANGLES);
    app->gl().Color4f(1, 0, 0, 0.5F);
    app->gl().Vertex2f(-1, -1);
    app->gl().Vertex2f(1, -1);
    app->gl().Vertex2f(0, 1);
    app->gl().End();
    app->end_frame();
    return app->read_pixels();
  };
  EXPECT_EQ(frame(true), frame(false));
  EXPECT_EQ(app->left(), left);
}

TEST(Refusals, ADeferredRunThatTurnsOutOtherwiseIsDrawnAsItWas) {
  // A material change between glBegin and glEnd: the run is given up halfway.
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  const auto frame = [&](bool under) {
    app->use_chain(under);
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app->gl().Clear(GL_COLOR_BUFFER_BIT);
    app->gl().Enable(GL_TEXTURE_3D);
    app->gl().Enable(GL_BLEND);
    app->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    constexpr std::array<GLfloat, 4> grey{0.5F, 0.5F, 0.5F, 1};
    for (const double z : {0.3, 0.5, 0.7}) {
      app->gl().Begin(GL_QUADS);
      app->gl().TexCoord3d(0, 0, z);
      app->gl().Vertex3d(-1, -1, 0);
      app->gl().TexCoord3d(1, 0, z);
      app->gl().Vertex3d(1, -1, 0);
      app->gl().Materialfv(GL_FRONT, GL_DIFFUSE, grey.data());
      app->gl().TexCoord3d(1, 1, z);
      app->gl().Vertex3d(1, 1, 0);
      app->gl().TexCoord3d(0, 1, z);
      app->gl().Vertex3d(-1, 1, 0);
      app->gl().End();
    }
    app->end_frame();
    return app->read_pixels();
  };
  const auto under = frame(true);
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(under, frame(false));
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
