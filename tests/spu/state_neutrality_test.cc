// SPDX-License-Identifier: Apache-2.0
// Every row of queryable OpenGL state (spu/track/state.h), and state that this table omits, is the same after a
// substituted draw as after the application's own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "slice_scenes.h"
#include "spu/chain.h"
#include "spu/track/state.h"

namespace understudy::spu::testing {
namespace {

using Dump = std::map<std::string, std::vector<double>>;

void dump_rows(const DispatchTable& gl, Dump& dump) {
  const State state = read_state(gl);
  for (const State::Item& item : state.items()) {
    const auto values = state.values(item);
    std::string name = fmt::format("{} {:#x}", call_name(item.row->set), item.row->queries[0].name);
    if (item.row->target != 0) name += fmt::format(" of {:#x}", item.row->target);
    if (item.row->matrix_mode != 0) name += fmt::format(" of matrix {:#x}", item.row->matrix_mode);
    dump[fmt::format("{} [{}] {}", name, item.number, item.row->from_value)] = {values.begin(), values.end()};
  }
}

void dump_textures(const DispatchTable& gl, bool core, Dump& dump) {
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (GLenum unit = 0; unit < 4; ++unit) {
    gl.ActiveTexture(GL_TEXTURE0 + unit);
    for (const GLenum target : {GL_TEXTURE_1D, GL_TEXTURE_2D, GL_TEXTURE_3D}) {
      const auto add = [&](GLenum name, std::vector<double> values) {
        dump[fmt::format("texture {:#x} of unit {}: {:#x}", target, unit, name)] = std::move(values);
      };
      for (const GLenum name :
           {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER, GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T,
            GL_TEXTURE_WRAP_R, GL_TEXTURE_BASE_LEVEL, GL_TEXTURE_MAX_LEVEL, GL_TEXTURE_COMPARE_MODE}) {
        GLint value = 0;
        gl.GetTexParameteriv(target, name, &value);
        add(name, {double(value)});
      }
      for (const GLenum name : {GL_TEXTURE_BORDER_COLOR, GL_TEXTURE_SWIZZLE_RGBA}) {
        std::array<GLfloat, 4> value{};
        gl.GetTexParameterfv(target, name, value.data());
        add(name, {value.begin(), value.end()});
      }
      for (const GLenum name :
           {GL_TEXTURE_WIDTH, GL_TEXTURE_HEIGHT, GL_TEXTURE_DEPTH, GL_TEXTURE_INTERNAL_FORMAT}) {
        GLint value = 0;
        gl.GetTexLevelParameteriv(target, 0, name, &value);
        add(name, {double(value)});
      }
      if (core) continue;
      GLfloat priority = 0;
      gl.GetTexParameterfv(target, GL_TEXTURE_PRIORITY, &priority);
      add(GL_TEXTURE_PRIORITY, {priority});
    }
  }
  gl.ActiveTexture(GLenum(active));
}

/// State that the rows omit and that only compatibility contexts have.
void dump_fixed_function(const DispatchTable& gl, Dump& dump) {
  const std::vector<std::pair<GLenum, std::size_t>> values = {{GL_CURRENT_RASTER_POSITION, 4},
                                                              {GL_CURRENT_RASTER_POSITION_VALID, 1},
                                                              {GL_CURRENT_RASTER_COLOR, 4},
                                                              {GL_CURRENT_RASTER_TEXTURE_COORDS, 4},
                                                              {GL_CURRENT_RASTER_DISTANCE, 1},
                                                              {GL_ATTRIB_STACK_DEPTH, 1},
                                                              {GL_CLIENT_ATTRIB_STACK_DEPTH, 1},
                                                              {GL_MODELVIEW_STACK_DEPTH, 1},
                                                              {GL_PROJECTION_STACK_DEPTH, 1},
                                                              {GL_TEXTURE_STACK_DEPTH, 1},
                                                              {GL_NAME_STACK_DEPTH, 1},
                                                              {GL_LIST_INDEX, 1},
                                                              {GL_LIST_MODE, 1},
                                                              {GL_LIST_BASE, 1},
                                                              {GL_RENDER_MODE, 1},
                                                              {GL_FEEDBACK_BUFFER_SIZE, 1},
                                                              {GL_FEEDBACK_BUFFER_TYPE, 1},
                                                              {GL_SELECTION_BUFFER_SIZE, 1}};
  for (const auto& [name, count] : values) {
    std::vector<double> value(count);
    gl.GetDoublev(name, value.data());
    dump[fmt::format("value {:#x}", name)] = value;
  }
  for (GLenum map = GL_PIXEL_MAP_I_TO_I; map <= GL_PIXEL_MAP_A_TO_A; ++map) {
    GLint size = 0;
    gl.GetIntegerv(map + (GL_PIXEL_MAP_I_TO_I_SIZE - GL_PIXEL_MAP_I_TO_I), &size);
    std::vector<GLfloat> entries(std::size_t(std::max(size, 1)));
    gl.GetPixelMapfv(map, entries.data());
    dump[fmt::format("pixel map {:#x}", map)] = {entries.begin(), entries.end()};
  }
  std::array<GLubyte, 128> stipple{};
  gl.GetPolygonStipple(stipple.data());
  dump["polygon stipple"] = {stipple.begin(), stipple.end()};
  for (const GLenum name :
       {GL_VERTEX_ARRAY_POINTER, GL_NORMAL_ARRAY_POINTER, GL_COLOR_ARRAY_POINTER,
        GL_TEXTURE_COORD_ARRAY_POINTER, GL_FEEDBACK_BUFFER_POINTER, GL_SELECTION_BUFFER_POINTER}) {
    void* pointer = nullptr;
    gl.GetPointerv(name, &pointer);
    dump[fmt::format("pointer {:#x}", name)] = {double(reinterpret_cast<std::uintptr_t>(pointer))};
  }
  for (const GLenum target : {GL_VERTEX_PROGRAM_ARB, GL_FRAGMENT_PROGRAM_ARB}) {
    GLint bound = 0;
    gl.GetProgramivARB(target, GL_PROGRAM_BINDING_ARB, &bound);
    dump[fmt::format("assembly program {:#x}", target)] = {double(bound), double(gl.IsEnabled(target))};
  }
}

Dump dump_state(const DispatchTable& gl, bool core) {
  Dump dump;
  dump_rows(gl, dump);
  dump_textures(gl, core, dump);
  if (!core) dump_fixed_function(gl, dump);
  dump["error"] = {double(gl.GetError())};
  return dump;
}

/// Sets values that differ from their defaults, to distinguish restored values from reset ones; none affects
/// the image.
void mark(const DispatchTable& gl, bool core) {
  gl.PolygonOffset(1.5F, 2.5F);
  gl.StencilFunc(GL_GEQUAL, 3, 0x7F);
  gl.StencilOp(GL_INCR, GL_DECR, GL_INVERT);
  gl.StencilMask(0x5A);
  gl.BlendColor(0.1F, 0.2F, 0.3F, 0.4F);
  gl.LogicOp(GL_XOR);
  gl.PointSize(3);
  gl.LineWidth(1.25F);
  gl.FrontFace(GL_CW);
  gl.CullFace(GL_FRONT);
  gl.ClearDepth(0.75);
  gl.ClearStencil(5);
  gl.SampleCoverage(0.5F, GL_TRUE);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 2);
  gl.PixelStorei(GL_PACK_SKIP_ROWS, 1);
  gl.PixelStorei(GL_UNPACK_ROW_LENGTH, 77);
  gl.PixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Scissor(1, 2, 90, 91);
  gl.Disable(GL_DITHER);
  gl.Hint(GL_LINE_SMOOTH_HINT, GL_NICEST);
  GLuint framebuffer_buffer = 0;
  gl.GenRenderbuffers(1, &framebuffer_buffer);
  gl.BindRenderbuffer(GL_RENDERBUFFER, framebuffer_buffer);
  GLuint sampler = 0;
  gl.GenSamplers(1, &sampler);
  gl.BindSampler(3, sampler);
  std::array<GLuint, 3> buffers{};
  gl.GenBuffers(3, buffers.data());
  gl.BindBuffer(GL_UNIFORM_BUFFER, buffers[0]);
  gl.BufferData(GL_UNIFORM_BUFFER, 512, nullptr, GL_STATIC_DRAW);
  gl.BindBufferRange(GL_UNIFORM_BUFFER, 1, buffers[0], 256, 64);
  gl.BindBuffer(GL_TRANSFORM_FEEDBACK_BUFFER, buffers[1]);
  gl.BufferData(GL_TRANSFORM_FEEDBACK_BUFFER, 512, nullptr, GL_STATIC_DRAW);
  gl.BindBufferRange(GL_TRANSFORM_FEEDBACK_BUFFER, 0, buffers[1], 16, 64);
  gl.BindBuffer(GL_COPY_READ_BUFFER, buffers[2]);
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, buffers[2]);
  GLuint spare = 0;
  gl.GenTextures(1, &spare);
  gl.ActiveTexture(GL_TEXTURE2);
  gl.BindTexture(GL_TEXTURE_2D, spare);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.GenTextures(1, &spare);
  gl.BindTexture(GL_TEXTURE_2D, spare);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (core) return;
  gl.Fogf(GL_FOG_DENSITY, 0.3F);
  gl.LineStipple(3, 0x0F0F);
  const std::array<GLubyte, 128> stipple{1, 2, 3, 4, 5};
  gl.PolygonStipple(stipple.data());
  const std::array<GLfloat, 4> map{0, 0.3F, 0.6F, 1};
  gl.PixelMapfv(GL_PIXEL_MAP_R_TO_R, 4, map.data());
  gl.RasterPos3d(0.1, 0.2, 0.3);
  gl.ClearAccum(0.1F, 0.2F, 0.3F, 0.4F);
  gl.PixelZoom(2, 3);
  gl.PushAttrib(GL_LINE_BIT);
  gl.PushClientAttrib(GL_CLIENT_PIXEL_STORE_BIT);
  gl.MatrixMode(GL_TEXTURE);
  gl.PushMatrix();
  gl.ActiveTexture(GL_TEXTURE1);
  gl.PushMatrix();
  gl.Translated(1, 2, 3);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.MatrixMode(GL_MODELVIEW);
  gl.PushMatrix();
  gl.ClientActiveTexture(GL_TEXTURE0);
  gl.MultiTexCoord4f(GL_TEXTURE3, 0.1F, 0.2F, 0.3F, 0.4F);
  gl.SecondaryColor3f(0.1F, 0.2F, 0.3F);
  gl.FogCoordf(0.7F);
  gl.EdgeFlag(GL_FALSE);
  gl.VertexAttrib4f(9, 1, 2, 3, 4);
  gl.ListBase(12);
  static std::array<GLfloat, 64> feedback{};
  gl.FeedbackBuffer(GLsizei(feedback.size()), GL_3D_COLOR, feedback.data());
  static std::array<GLuint, 16> selection{};
  gl.SelectBuffer(GLsizei(selection.size()), selection.data());
}

class NeutralState : public ::testing::TestWithParam<std::size_t> {};

/// The common and the less common ways of slicing.
std::vector<SliceScene> scenes() {
  std::vector<SliceScene> all = all_slice_scenes();
  for (const bool along_rays : {false, true}) all.push_back(pre_integrated_slices(along_rays));
  for (const GLenum mode : {GL_LINEAR, GL_EXP, GL_EXP2}) all.push_back(fixed_function_fog(mode));
  all.push_back(texture_stack_program(Profile::compatibility, GL_R8));
  all.push_back(texture_stack_program(Profile::core, GL_R16));
  all.push_back(view_space_slices());
  all.push_back(degenerate_strip());
  return all;
}

TEST_P(NeutralState, AfterASubstitutedDrawIsThatAfterTheApplicationsOwn) {
  const SliceScene scene = scenes()[GetParam()];
  auto app = GlApplication::start(scene.profile);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  scene.set_up(*app);
  const bool core = scene.profile == Profile::core;
  mark(app->gl(), core);
  ASSERT_EQ(app->error(), GLenum(GL_NO_ERROR));
  const auto frame = [&](bool under) {
    app->use_chain(under);
    scene.draw(*app, 30);
    if (under) Chain::current()->settle();
    return dump_state(app->driver(), core);
  };
  const Dump bare = frame(false);
  for (const int number : {1, 2}) {
    const Dump under = frame(true);
    EXPECT_EQ(app->substituted(), std::uint64_t(number)) << scene.name << ": " << app->last_reason();
    ASSERT_EQ(bare.size(), under.size());
    for (const auto& [name, values] : bare) {
      EXPECT_EQ(values, under.at(name)) << scene.name << ", frame " << number << ": " << name;
    }
  }
  std::printf("%s: %zu items equal\n", scene.name.c_str(), bare.size());
  EXPECT_GT(bare.size(), 400U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, NeutralState, ::testing::Range<std::size_t>(0, scenes().size()));

}  // namespace
}  // namespace understudy::spu::testing
