// SPDX-License-Identifier: Apache-2.0
// Ways of drawing a volume other than slices whose colour is a function of the sample: not substituted,
// bit-identical, with the correct reason.
#include <gtest/gtest.h>

#include <memory>

#include "colour_target.h"
#include "drawing.h"
#include "glsl_program.h"

namespace understudy::spu::testing {
namespace {

GLuint program(GlApplication& app, const char* fragment, const char* vertex = nullptr) {
  return glsl_program(app.gl(), vertex, fragment);
}

void load_field(GlApplication& app) {
  const Blob blob;
  app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_INTENSITY8, blob.x, blob.y, blob.z, 0, GL_LUMINANCE,
                      GL_UNSIGNED_BYTE, blob.texels().data());
}

void load_integers(GlApplication& app) {
  const Blob blob;
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    app.gl().TexParameteri(GL_TEXTURE_3D, filter, GL_NEAREST);
  app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R8UI, blob.x, blob.y, blob.z, 0, GL_RED_INTEGER, GL_UNSIGNED_BYTE,
                      blob.texels().data());
}

void assembly(GlApplication& app, const std::string& text) {
  GLuint name = 0;
  app.gl().GenProgramsARB(1, &name);
  app.gl().BindProgramARB(GL_FRAGMENT_PROGRAM_ARB, name);
  app.gl().ProgramStringARB(GL_FRAGMENT_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB, GLsizei(text.size()),
                            text.data());
  app.gl().Enable(GL_FRAGMENT_PROGRAM_ARB);
}

void box_faces(GlApplication& app) {
  app.gl().Enable(GL_BLEND);
  app.gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  app.gl().Enable(GL_CULL_FACE);
  app.gl().Begin(GL_QUADS);
  for (const int axis : {0, 1, 2}) {
    for (const int side : {0, 1}) {
      for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        std::array<double, 3> p{};
        p[std::size_t(axis)] = side;
        p[std::size_t(axis + 1) % 3] = side != 0 ? u : v;
        p[std::size_t(axis + 2) % 3] = side != 0 ? v : u;
        app.gl().TexCoord3d(p[0], p[1], p[2]);
        app.gl().Vertex3d(p[0] - 0.5, p[1] - 0.5, p[2] - 0.5);
      }
    }
  }
  app.gl().End();
  app.gl().Disable(GL_CULL_FACE);
  app.gl().Disable(GL_BLEND);
}

struct Drawing {
  const char* name;
  const char* reason;
  std::function<void(GlApplication&)> set_up;
  std::function<void(GlApplication&)> draw;
};

void cube_in_front(GlApplication& app) {
  look(app, View::perspective, 25);
  draw_cube(app);
}

std::vector<Drawing> drawings() {
  return {
      {"LightingWithNormalsThatVary", "the colour varies over the slices (lighting with a varying normal)",
       [](GlApplication& app) {
         app.gl().Enable(GL_LIGHTING);
         app.gl().Enable(GL_LIGHT0);
       },
       [](GlApplication& app) {
         look(app, View::perspective, 25);
         app.gl().Enable(GL_BLEND);
         app.gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
         app.gl().Enable(GL_TEXTURE_3D);
         app.gl().Begin(GL_QUADS);
         for (int i = 0; i < 20; ++i) {
           const double z = (i + 0.5) / 20;
           for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
             app.gl().Normal3d(x - 0.5, y - 0.5, 0.7);
             app.gl().TexCoord3d(x, y, z);
             app.gl().Vertex3d(x - 0.5, y - 0.5, z - 0.5);
           }
         }
         app.gl().End();
         app.gl().Disable(GL_TEXTURE_3D);
         app.gl().Disable(GL_BLEND);
       }},
      {"ShadingByTheFieldsGradient",
       "the fragment shader: colours depend on a second texel of 'field' at an offset",
       [](GlApplication& app) {
         load_field(app);
         app.gl().UseProgram(program(app,
                                     "#version 120\n"
                                     "uniform sampler3D field;\n"
                                     "float at(vec3 p) { return texture3D(field, gl_TexCoord[0].xyz + p).r; }\n"
                                     "void main() {\n"
                                     "  const float d = 1.0 / 256.0;\n"
                                     "  vec3 slope = vec3(at(vec3(d, 0, 0)) - at(vec3(-d, 0, 0)),\n"
                                     "                    at(vec3(0, d, 0)) - at(vec3(0, -d, 0)),\n"
                                     "                    at(vec3(0, 0, d)) - at(vec3(0, 0, -d)));\n"
                                     "  float light = 0.8 + 10.0 * dot(slope, vec3(0.6, 0.0, 0.8));\n"
                                     "  float s = at(vec3(0));\n"
                                     "  gl_FragColor = vec4(light * s, light, 0.3, 0.2 * s);\n"
                                     "}\n"));
       },
       cube_in_front},
      {"PreIntegratedSegmentsThatFadeWithTheirPlace", "the fragment shader: colours depend on varying front.x",
       [](GlApplication& app) {
         load_field(app);
         app.gl().UseProgram(program(app,
                                     "#version 120\n"
                                     "uniform sampler3D field;\n"
                                     "varying vec3 front, back;\n"
                                     "void main() {\n"
                                     "  float a = texture3D(field, front).r, b = texture3D(field, back).r;\n"
                                     "  gl_FragColor = vec4(a, b, 0.5 * (a + b), 0.1 * (a + b) * front.x);\n"
                                     "}\n",
                                     "#version 120\n"
                                     "varying vec3 front, back;\n"
                                     "void main() {\n"
                                     "  front = gl_MultiTexCoord0.xyz;\n"
                                     "  back = front + vec3(0.0, 0.0, -0.025);\n"
                                     "  gl_Position = ftransform();\n"
                                     "}\n"));
       },
       cube_in_front},
      {"ColourByThePlaceOnTheScreen", "the fragment shader reads gl_FragCoord",
       [](GlApplication& app) {
         load_field(app);
         app.gl().UseProgram(program(app,
                                     "#version 120\n"
                                     "uniform sampler3D field;\n"
                                     "void main() { gl_FragColor = vec4(fract(gl_FragCoord.xyz * 0.1),\n"
                                     "    0.1 * texture3D(field, gl_TexCoord[0].xyz).r); }\n"));
       },
       cube_in_front},
      {"AVolumeOfIntegers", "the program samples a 3-D texture of integers",
       [](GlApplication& app) {
         load_integers(app);
         app.gl().UseProgram(program(app,
                                     "#version 130\n"
                                     "uniform usampler3D field;\n"
                                     "void main() {\n"
                                     "  float s = float(texture(field, gl_TexCoord[0].xyz).r) / 255.0;\n"
                                     "  gl_FragColor = vec4(s, s, 0.5, 0.2 * s);\n"
                                     "}\n"));
       },
       cube_in_front},
      {"AFullScreenRayCasterWithoutGeometry", nullptr,
       [](GlApplication& app) {
         load_field(app);
         app.gl().UseProgram(
             program(app,
                     "#version 120\n"
                     "uniform sampler3D field;\n"
                     "void main() {\n"
                     "  vec4 sum = vec4(0);\n"
                     "  for (int i = 0; i < 40; ++i) {\n"
                     "    float s = texture3D(field, vec3(gl_TexCoord[0].xy, (float(i) + 0.5) / 40.0)).r;\n"
                     "    sum += (1.0 - sum.a) * vec4(s, s, 0.5, 1.0) * 0.1 * s;\n"
                     "  }\n"
                     "  gl_FragColor = sum;\n"
                     "}\n"));
       },
       [](GlApplication& app) {
         for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
           app.gl().MatrixMode(matrix);
           app.gl().LoadIdentity();
         }
         app.gl().Enable(GL_BLEND);
         app.gl().BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
         app.gl().Begin(GL_QUADS);
         for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
           app.gl().TexCoord2d(x, y);
           app.gl().Vertex2d(2 * x - 1, 2 * y - 1);
         }
         app.gl().End();
         app.gl().Disable(GL_BLEND);
       }},
      {"ARayCasterOnTheFacesOfABox", nullptr,
       [](GlApplication& app) {
         load_field(app);
         app.gl().UseProgram(
             program(app,
                     "#version 120\n"
                     "uniform sampler3D field;\n"
                     "void main() {\n"
                     "  vec4 sum = vec4(0);\n"
                     "  for (int i = 0; i < 40; ++i) {\n"
                     "    float s = texture3D(field, gl_TexCoord[0].xyz - vec3(0, 0, float(i) / 40.0)).r;\n"
                     "    sum += (1.0 - sum.a) * vec4(s, s, 0.5, 1.0) * 0.1 * s;\n"
                     "  }\n"
                     "  gl_FragColor = sum;\n"
                     "}\n"));
       },
       [](GlApplication& app) {
         look(app, View::perspective, 25);
         box_faces(app);
       }},
      {"AssemblyThatReadsAnotherCoordinate",
       "the fragment shader: colours depend on varying fragment.texcoord[1].xyzw",
       [](GlApplication& app) {
         load_field(app);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "TEMP field;\n"
                  "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
                  "MUL result.color, field, fragment.texcoord[1];\n"
                  "END\n");
         app.gl().MultiTexCoord4f(GL_TEXTURE1, 0.5F, 0.6F, 0.7F, 0.1F);
       },
       cube_in_front},
      {"AssemblyThatReadsThePosition", "the fragment shader: colours depend on fragment.position.xyz",
       [](GlApplication& app) {
         load_field(app);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "TEMP field, place;\n"
                  "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
                  "MUL place, fragment.position, 0.01;\n"
                  "MUL result.color, field, place;\n"
                  "MUL result.color.a, field, 0.1;\n"
                  "END\n");
       },
       cube_in_front},
      {"AssemblyThatReadsTheCamera",
       "the fragment program reads 'state.matrix.modelview.row[0]', whose changes are not followed",
       [](GlApplication& app) {
         load_field(app);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "TEMP field;\n"
                  "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
                  "MUL result.color.rgb, field, state.matrix.modelview.row[0].x;\n"
                  "MUL result.color.a, field, 0.1;\n"
                  "END\n");
       },
       cube_in_front},
      {"AssemblyThatReadsAnUnknownTable",
       "colours come from 'texture[2]', a sampler1D, whose contents are not followed",
       [](GlApplication& app) {
         load_field(app);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "TEMP field;\n"
                  "TEX field, fragment.texcoord[0], texture[0], 3D;\n"
                  "TEX result.color, field, texture[2], 1D;\n"
                  "END\n");
       },
       cube_in_front},
      {"AssemblyWithAnUnknownOption",
       "the fragment program in assembly language is not understood: OPTION "
       "ARB_fragment_coord_pixel_center_integer",
       [](GlApplication& app) {
         load_field(app);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "OPTION ARB_fragment_coord_pixel_center_integer;\n"
                  "TEX result.color, fragment.texcoord[0], texture[0], 3D;\n"
                  "END\n");
       },
       cube_in_front},
      {"AssemblyBesideTwoVolumes", "an assembly program runs while more than one 3-D texture is bound",
       [](GlApplication& app) {
         app.gl().ActiveTexture(GL_TEXTURE3);
         load_colours(app, true);
         app.gl().ActiveTexture(GL_TEXTURE0);
         assembly(app,
                  "!!ARBfp1.0\n"
                  "TEX result.color, fragment.texcoord[0], texture[0], 3D;\n"
                  "END\n");
       },
       cube_in_front},
      {"AssemblyUnderClipPlanes", "clip planes cut what a vertex assembly program draws",
       [](GlApplication& app) {
         GLuint name = 0;
         const std::string text =
             "!!ARBvp1.0\n"
             "OPTION ARB_position_invariant;\n"
             "MOV result.texcoord[0], vertex.texcoord[0];\n"
             "MOV result.color, vertex.color;\n"
             "END\n";
         app.gl().GenProgramsARB(1, &name);
         app.gl().BindProgramARB(GL_VERTEX_PROGRAM_ARB, name);
         app.gl().ProgramStringARB(GL_VERTEX_PROGRAM_ARB, GL_PROGRAM_FORMAT_ASCII_ARB, GLsizei(text.size()),
                                   text.data());
         app.gl().Enable(GL_VERTEX_PROGRAM_ARB);
         app.gl().Enable(GL_CLIP_PLANE0);
         app.gl().Color4f(1, 1, 1, 1);
       },
       cube_in_front},
      {"AStencilThatCutsTheVolume", "the stencil test is enabled",
       [](GlApplication& app) { app.gl().StencilFunc(GL_ALWAYS, 1, 255); },
       [](GlApplication& app) {
         look(app, View::perspective, 25);
         app.gl().Enable(GL_STENCIL_TEST);
         draw_cube(app);
         app.gl().Disable(GL_STENCIL_TEST);
       }},
  };
}

class RefusedDrawing : public ::testing::TestWithParam<Drawing> {};

TEST_P(RefusedDrawing, IsLeftBitIdentical) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  load_colours(*app);
  GetParam().set_up(*app);
  ASSERT_EQ(app->error(), GLenum(GL_NO_ERROR));
  const auto frame = [&](bool under, bool with_volume) {
    app->use_chain(under);
    app->gl().Viewport(0, 0, GlApplication::size, GlApplication::size);
    app->gl().ClearColor(0.1F, 0.2F, 0.3F, 1);
    app->gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (with_volume) GetParam().draw(*app);
    app->end_frame();
    return app->read_pixels();
  };
  const auto bare = frame(false, true);
  EXPECT_NE(bare, frame(false, false)) << "there is nothing to be seen";
  for (int i = 0; i < 3; ++i) EXPECT_EQ(frame(true, true), bare) << "frame " << i;
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_GE(app->left(), 1U);
  if (GetParam().reason != nullptr) {
    EXPECT_EQ(app->last_reason(), GetParam().reason);
  }
  std::printf("%s: %s\n", GetParam().name, app->last_reason().c_str());
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

INSTANTIATE_TEST_SUITE_P(Of, RefusedDrawing, ::testing::ValuesIn(drawings()),
                         [](const auto& info) { return std::string(info.param.name); });

/// Each slice is drawn twice: to the screen, lit by the light buffer, and into the light buffer.
TEST(RefusedDrawings, HalfAngleSlicingIsLeftBitIdentical) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  load_colours(*app);
  const ColourTarget light(*app, GL_RGBA8);
  const ColourTarget eye(*app, GL_RGBA8);
  GLint eye_name = 0;
  app->gl().GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &eye_name);
  const GLint light_name = eye_name - 2;
  ASSERT_TRUE(app->gl().IsFramebuffer(GLuint(light_name)));
  const auto frame = [&](bool under) {
    app->use_chain(under);

    for (const GLint target : {light_name, eye_name}) {
      app->gl().BindFramebuffer(GL_FRAMEBUFFER, GLuint(target));
      eye.clear({0.1F, 0.2F, 0.3F, 1});
    }
    app->gl().Enable(GL_BLEND);
    app->gl().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    app->gl().Enable(GL_TEXTURE_3D);
    for (int i = 0; i < 20; ++i) {
      for (const GLint target : {eye_name, light_name}) {
        app->gl().BindFramebuffer(GL_FRAMEBUFFER, GLuint(target));
        look(*app, View::perspective, target == eye_name ? 25 : -40);
        app->gl().Begin(GL_QUADS);
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
          app->gl().TexCoord3d(x, y, (i + 0.5) / 20);
          app->gl().Vertex3d(x - 0.5, y - 0.5, (i + 0.5) / 20 - 0.5);
        }
        app->gl().End();
      }
    }
    app->gl().Disable(GL_TEXTURE_3D);
    app->gl().Disable(GL_BLEND);
    app->end_frame();
    std::vector<float> both;
    for (const GLint target : {light_name, eye_name}) {
      app->gl().BindFramebuffer(GL_FRAMEBUFFER, GLuint(target));
      const auto pixels = app->read_pixels();
      both.insert(both.end(), pixels.begin(), pixels.end());
    }
    return both;
  };
  const auto bare = frame(false);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(frame(true), bare);
  EXPECT_EQ(app->substituted(), 0U);
  EXPECT_EQ(app->last_reason(), "the draw does not span the volume (a single slice or face)");
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
