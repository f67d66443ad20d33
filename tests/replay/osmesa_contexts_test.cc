// SPDX-License-Identifier: Apache-2.0
// Contexts on OSMesa behave like contexts on EGL, although their single colour buffer is a front buffer and
// framebuffers are not shared.
#include "apps/understudy/offscreen/osmesa_contexts.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/understudy/cli/compare.h"
#include "apps/understudy/cli/play.h"
#include "apps/understudy/images/image.h"
#include "apps/understudy/images/read_image.h"
#include "spu/window_system/shown_image.h"

#if defined(__SANITIZE_ADDRESS__)
/// Suppresses leak reports for memory that Mesa keeps until the process ends.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:libOSMesa\nleak:libLLVM\nleak:libglapi\n";
}
#endif

namespace understudy::replay_test {
namespace {

namespace fs = std::filesystem;

using testing::ElementsAre;
using Colour = std::array<float, 4>;

constexpr spu::Extent2D extent{32, 24};
constexpr Colour red = {1, 0, 0, 1}, green = {0, 1, 0, 1}, blue = {0, 0, 1, 1}, black = {0, 0, 0, 0};

spu::RecordedContext context(std::uint64_t number, std::uint64_t shares_with = 0) {
  return {.number = number,
          .shares_with = shares_with,
          .version = 450,
          .profile = GL_CONTEXT_COMPATIBILITY_PROFILE_BIT};
}

spu::RecordedContext core_context(std::uint64_t number, int version) {
  return {.number = number, .version = version, .profile = GL_CONTEXT_CORE_PROFILE_BIT};
}

class Osmesa : public testing::Test {
 protected:
  const spu::DispatchTable& gl() const { return windows.driver(); }
  void add(const spu::RecordedContext& wanted) {
    windows.create(wanted);
    windows.make_current(wanted.number, 0, extent);
  }
  void fill(const Colour& colour) const {
    gl().ClearColor(colour[0], colour[1], colour[2], colour[3]);
    gl().Clear(GL_COLOR_BUFFER_BIT);
  }
  /// The colour of the whole window; -1 if there are several colours.
  Colour shown(spu::Extent2D size = extent) const {
    const auto pixels = spu::shown_image(gl(), size);
    for (std::size_t i = 4; i < pixels.size(); ++i)
      if (pixels[i] != pixels[i % 4]) return {-1, -1, -1, -1};
    return {float(pixels[0]) / 255, float(pixels[1]) / 255, float(pixels[2]) / 255, float(pixels[3]) / 255};
  }
  GLint integer(GLenum name) const {
    GLint value = -7;
    gl().GetIntegerv(name, &value);
    return value;
  }
  float depth_at(int x, int y) const {
    float depth = -1;
    gl().ReadPixels(x, y, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    return depth;
  }
  void expect_no_error() const { EXPECT_EQ(gl().GetError(), GLenum(GL_NO_ERROR)); }
  GLuint framebuffer_with_texture() const {
    GLuint texture = 0, framebuffer = 0;
    gl().GenTextures(1, &texture);
    gl().BindTexture(GL_TEXTURE_2D, texture);
    gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl().GenFramebuffers(1, &framebuffer);
    gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    return framebuffer;
  }

  launcher::OsmesaContexts windows;
};

TEST_F(Osmesa, BeginsWithTheBackBuffer) {
  add(context(1));
  for (const GLenum name : {GL_DRAW_BUFFER, GL_DRAW_BUFFER0, GL_READ_BUFFER}) {
    EXPECT_EQ(integer(name), GL_BACK) << name;
    GLfloat as_float = 0;
    gl().GetFloatv(name, &as_float);
    EXPECT_EQ(as_float, float(GL_BACK));
    GLdouble as_double = 0;
    gl().GetDoublev(name, &as_double);
    EXPECT_EQ(as_double, double(GL_BACK));
    GLint64 as_long = 0;
    gl().GetInteger64v(name, &as_long);
    EXPECT_EQ(as_long, GLint64(GL_BACK));
    GLboolean as_boolean = GL_FALSE;
    gl().GetBooleanv(name, &as_boolean);
    EXPECT_EQ(as_boolean, GL_TRUE);
  }
  EXPECT_EQ(integer(GL_DRAW_BUFFER1), GL_NONE);
  EXPECT_EQ(integer(GL_DOUBLEBUFFER), GL_TRUE);
  GLboolean doubled = GL_FALSE;
  gl().GetBooleanv(GL_DOUBLEBUFFER, &doubled);
  EXPECT_EQ(doubled, GL_TRUE);
  expect_no_error();
}

TEST_F(Osmesa, ASinglyBufferedContextSaysWhatTheDriverSays) {
  spu::RecordedContext wanted = context(1);
  wanted.double_buffered = false;
  add(wanted);
  EXPECT_EQ(integer(GL_DOUBLEBUFFER), GL_FALSE);
  EXPECT_EQ(integer(GL_DRAW_BUFFER), GL_FRONT);
  fill(red);
  EXPECT_EQ(shown(), red);
  expect_no_error();
}

TEST_F(Osmesa, DrawsIntoTheBackBufferByAllItsNames) {
  add(context(1));
  const GLenum back = GL_BACK, back_left = GL_BACK_LEFT;
  const std::array<GLenum, 2> second = {GL_NONE, GL_BACK_LEFT};
  const std::function<void()> ways[] = {
      [&] { gl().DrawBuffer(GL_BACK); },
      [&] { gl().DrawBuffer(GL_BACK_LEFT); },
      [&] { gl().DrawBuffers(1, &back_left); },
      [&] { gl().DrawBuffers(1, &back); },
      [&] { gl().DrawBuffersARB(1, &back_left); },
      [&] { gl().NamedFramebufferDrawBuffer(0, GL_BACK); },
      [&] { gl().NamedFramebufferDrawBuffer(0, GL_BACK_LEFT); },
      [&] { gl().NamedFramebufferDrawBuffers(0, 1, &back_left); },
      [&] { gl().FramebufferDrawBufferEXT(0, GL_BACK); },
      [&] { gl().FramebufferDrawBuffersEXT(0, 1, &back_left); },
      [&] {
        const GLuint list = gl().GenLists(1);
        gl().NewList(list, GL_COMPILE);
        gl().DrawBuffer(GL_BACK);
        gl().EndList();
        gl().CallList(list);
      },
      [&] {
        gl().DrawBuffer(GL_BACK);
        gl().PushAttrib(GL_COLOR_BUFFER_BIT);
        gl().DrawBuffer(GL_NONE);
        gl().PopAttrib();
      },
  };
  int number = 0;
  for (const auto& draw_into_back : ways) {
    SCOPED_TRACE(number++);
    fill(black);
    gl().DrawBuffer(GL_NONE);
    fill(red);
    EXPECT_EQ(shown(), black);
    draw_into_back();
    expect_no_error();
    EXPECT_THAT(integer(GL_DRAW_BUFFER), testing::AnyOf(GL_BACK, GL_BACK_LEFT));
    EXPECT_EQ(integer(GL_DRAW_BUFFER0), integer(GL_DRAW_BUFFER));
    fill(green);
    EXPECT_EQ(shown(), green);
  }
  gl().DrawBuffers(2, second.data());
  EXPECT_EQ(integer(GL_DRAW_BUFFER0), GL_NONE);
  EXPECT_EQ(integer(GL_DRAW_BUFFER1), GL_BACK_LEFT);
  expect_no_error();
  // In a list, GL_BACK is allowed only alone.
  const std::array<GLenum, 2> wrong = {GL_BACK, GL_NONE};
  gl().DrawBuffers(2, wrong.data());
  EXPECT_NE(gl().GetError(), GLenum(GL_NO_ERROR));
}

TEST_F(Osmesa, ReadsTheBackBufferByAllItsNames) {
  add(context(1));
  fill(blue);
  const std::function<void()> ways[] = {
      [&] { gl().ReadBuffer(GL_BACK); },
      [&] { gl().ReadBuffer(GL_BACK_LEFT); },
      [&] { gl().NamedFramebufferReadBuffer(0, GL_BACK); },
      [&] { gl().FramebufferReadBufferEXT(0, GL_BACK); },
      [&] {
        gl().ReadBuffer(GL_BACK);
        gl().PushAttrib(GL_PIXEL_MODE_BIT);
        gl().ReadBuffer(GL_NONE);
        gl().PopAttrib();
      },
  };
  for (const auto& read_from_back : ways) {
    gl().ReadBuffer(GL_NONE);
    read_from_back();
    EXPECT_THAT(integer(GL_READ_BUFFER), testing::AnyOf(GL_BACK, GL_BACK_LEFT));
    std::array<std::uint8_t, 4> pixel{};
    gl().ReadPixels(3, 3, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
    EXPECT_THAT(pixel, ElementsAre(0, 0, 255, 255));
    expect_no_error();
  }
}

TEST_F(Osmesa, SaysOfTheBackBufferWhatItIs) {
  add(context(1));
  for (const GLenum buffer : {GL_BACK, GL_BACK_LEFT}) {
    GLint bits = 0, kind = 0;
    gl().GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, buffer, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE,
                                             &kind);
    EXPECT_EQ(kind, GL_FRAMEBUFFER_DEFAULT);
    gl().GetNamedFramebufferAttachmentParameteriv(0, buffer, GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, &bits);
    EXPECT_EQ(bits, 8);
  }
  GLint doubled = -1;
  gl().GetFramebufferParameteriv(GL_DRAW_FRAMEBUFFER, GL_DOUBLEBUFFER, &doubled);
  EXPECT_EQ(doubled, GL_TRUE);
  doubled = -1;
  gl().GetNamedFramebufferParameteriv(0, GL_DOUBLEBUFFER, &doubled);
  EXPECT_EQ(doubled, GL_TRUE);
  expect_no_error();
}

TEST_F(Osmesa, LeavesFramebufferObjectsAlone) {
  add(context(1));
  const GLuint framebuffer = framebuffer_with_texture();
  EXPECT_EQ(integer(GL_DRAW_BUFFER), GL_COLOR_ATTACHMENT0);
  EXPECT_EQ(integer(GL_READ_BUFFER), GL_COLOR_ATTACHMENT0);
  EXPECT_EQ(integer(GL_DOUBLEBUFFER), GL_FALSE);
  GLint doubled = -1;
  gl().GetNamedFramebufferParameteriv(framebuffer, GL_DOUBLEBUFFER, &doubled);
  EXPECT_EQ(doubled, GL_FALSE);
  expect_no_error();
  gl().DrawBuffer(GL_BACK);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_OPERATION));
  gl().NamedFramebufferDrawBuffer(framebuffer, GL_BACK);
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_OPERATION));
  // Framebuffer 0 can be accessed by name meanwhile.
  gl().NamedFramebufferDrawBuffer(0, GL_BACK);
  expect_no_error();
}

TEST_F(Osmesa, AQuestionThatIsAnErrorLeavesMemoryAlone) {
  add(context(1));
  GLint value = GL_FRONT;
  gl().Begin(GL_POINTS);
  gl().GetIntegerv(GL_DRAW_BUFFER, &value);
  gl().End();
  EXPECT_EQ(gl().GetError(), GLenum(GL_INVALID_OPERATION));
  EXPECT_EQ(value, GL_FRONT);
}

TEST_F(Osmesa, CoreContexts) {
  add(core_context(1, 330));
  EXPECT_NE(integer(GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT, 0);
  EXPECT_GE(integer(GL_MAJOR_VERSION) * 10 + integer(GL_MINOR_VERSION), 33);
  EXPECT_EQ(integer(GL_DRAW_BUFFER), GL_BACK);
  gl().DrawBuffer(GL_BACK);
  fill(red);
  EXPECT_EQ(shown(), red);
  windows.make_current(1, 5, extent);
  EXPECT_EQ(shown(), black);
  windows.make_current(1, 0, extent);
  EXPECT_EQ(shown(), red);
  expect_no_error();
}

TEST_F(Osmesa, TheHighestVersionIsOneThatCanBeMade) {
  for (const bool core : {false, true}) {
    const int version = windows.highest_version(core);
    ASSERT_GE(version, 330);
    spu::RecordedContext wanted = core ? core_context(1, version) : context(1);
    wanted.version = version;
    testing::internal::CaptureStderr();
    add(wanted);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_GE(integer(GL_MAJOR_VERSION) * 100 + integer(GL_MINOR_VERSION) * 10, version);
    windows.release_current();
    windows.destroy(1);
  }
}

TEST_F(Osmesa, AContextOfALaterVersionIsReplacedAndThatIsSaid) {
  testing::internal::CaptureStderr();
  add(core_context(1, 990));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("the trace needs OpenGL 9.9"));
  EXPECT_GE(integer(GL_MAJOR_VERSION), 3);
}

TEST_F(Osmesa, ContextsThatShareHaveEachOthersTexturesAndLists) {
  add(context(1));
  GLuint texture = 0;
  gl().GenTextures(1, &texture);
  gl().BindTexture(GL_TEXTURE_2D, texture);
  const std::array<std::uint8_t, 4> colour = {250, 120, 10, 255};
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, colour.data());
  const GLuint list = gl().GenLists(1);
  gl().NewList(list, GL_COMPILE);
  gl().DrawBuffer(GL_BACK);
  gl().ClearColor(0, 1, 0, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  gl().EndList();
  windows.release_current();
  add(context(2, 1));
  EXPECT_TRUE(gl().IsTexture(texture));
  gl().CallList(list);
  EXPECT_EQ(shown(), green);
  windows.release_current();
  add(context(3));
  EXPECT_FALSE(gl().IsTexture(texture));
  expect_no_error();
}

TEST_F(Osmesa, DrawablesKeepWhatWasDrawnIntoThem) {
  add(context(1));
  windows.make_current(1, 7, extent);
  fill(red);
  windows.make_current(1, 8, extent);
  EXPECT_EQ(shown(), black) << "a new drawable is cleared";
  fill(green);
  windows.make_current(1, 7, extent);
  EXPECT_EQ(shown(), red);
  windows.make_current(1, 9, {8, 8});
  fill(blue);
  windows.make_current(1, 8, extent);
  EXPECT_EQ(shown(), green);
  windows.make_current(1, 9, {8, 8});
  EXPECT_EQ(shown({8, 8}), blue);
  windows.make_current(1, 0, extent);
  EXPECT_EQ(shown(), black);
  expect_no_error();
}

TEST_F(Osmesa, DrawablesAreSharedByContextsWithDepthAndStencil) {
  add(context(1));
  windows.make_current(1, 7, extent);
  fill(red);
  gl().ClearDepth(0.25);
  gl().ClearStencil(0x35);
  gl().Clear(GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  gl().Scissor(0, 0, 4, 4);
  gl().Enable(GL_SCISSOR_TEST);
  fill(green);
  // A different share group and a different profile.
  windows.create(core_context(2, 330));
  windows.make_current(2, 7, extent);
  EXPECT_EQ(shown({4, 4}), green);
  EXPECT_EQ(shown()[0], -1) << "the rest is red";
  EXPECT_NEAR(depth_at(20, 20), 0.25, 1e-6);
  std::uint8_t stencil = 0;
  gl().ReadPixels(20, 20, 1, 1, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, &stencil);
  EXPECT_EQ(stencil, 0x35);
  fill(blue);
  expect_no_error();
  windows.make_current(1, 7, extent);
  EXPECT_EQ(shown(), blue);
  EXPECT_NEAR(depth_at(20, 20), 0.25, 1e-6);
  // A window outlives a context.
  windows.make_current(2, 7, extent);
  fill(green);
  windows.release_current();
  windows.destroy(2);
  windows.make_current(1, 7, extent);
  EXPECT_EQ(shown(), green);
  expect_no_error();
}

TEST_F(Osmesa, AContextThatGoesLeavesTheCurrentOneCurrent) {
  add(context(1));
  add(context(2, 1));
  windows.make_current(2, 7, extent);
  fill(green);
  windows.make_current(1, 8, extent);
  windows.destroy(2);
  fill(red);
  EXPECT_EQ(shown(), red);
  windows.make_current(1, 7, extent);
  EXPECT_EQ(shown(), green);
  windows.make_current(1, 8, extent);
  EXPECT_EQ(shown(), red);
  expect_no_error();
}

TEST_F(Osmesa, ADrawableThatChangesItsSizeIsCleared) {
  add(context(1));
  for (const std::uint64_t drawable : {0, 7}) {
    windows.make_current(1, drawable, extent);
    fill(red);
    windows.make_current(1, drawable, {64, 48});
    EXPECT_EQ(shown({64, 48}), black);
    EXPECT_EQ(depth_at(60, 40), 1);
    fill(green);
    windows.make_current(1, drawable, extent);
    EXPECT_EQ(shown(), black);
  }
  // The same after another context has drawn into it.
  windows.make_current(1, 7, extent);
  fill(red);
  windows.create(context(2));
  windows.make_current(2, 7, {16, 16});
  EXPECT_EQ(shown({16, 16}), black);
  fill(blue);
  windows.make_current(1, 7, {16, 16});
  EXPECT_EQ(shown({16, 16}), blue);
  expect_no_error();
}

TEST_F(Osmesa, ContextsWithoutDepthShareDrawablesWithThoseThatHaveIt) {
  add(context(1));
  windows.make_current(1, 7, extent);
  fill(red);
  spu::RecordedContext flat = context(2);
  flat.depth = flat.stencil = 0;
  windows.create(flat);
  windows.make_current(2, 7, extent);
  EXPECT_EQ(integer(GL_DEPTH_BITS), 0);
  EXPECT_EQ(shown(), red);
  fill(green);
  windows.make_current(1, 7, extent);
  EXPECT_EQ(shown(), green);
  EXPECT_EQ(depth_at(3, 3), 1);
  expect_no_error();
}

/// Moving a window's contents uses the application's context, and must preserve its state.
TEST_F(Osmesa, TheStateOfContextsIsUntouchedByWhatMovesBetweenDrawables) {
  add(context(1));
  windows.make_current(1, 7, extent);
  fill(red);
  const GLuint framebuffer = framebuffer_with_texture();
  const GLint texture = integer(GL_TEXTURE_BINDING_2D);
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
  gl().BufferData(GL_PIXEL_UNPACK_BUFFER, 64, nullptr, GL_STATIC_DRAW);
  gl().BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
  gl().PixelStorei(GL_UNPACK_ROW_LENGTH, 77);
  gl().PixelStorei(GL_PACK_SKIP_ROWS, 3);
  gl().PixelTransferf(GL_RED_SCALE, 0.5F);
  gl().PixelTransferf(GL_DEPTH_BIAS, 0.5F);
  gl().Enable(GL_SCISSOR_TEST);
  gl().Scissor(1, 1, 2, 2);
  gl().ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_FALSE);
  gl().DepthMask(GL_FALSE);
  gl().StencilMask(0x0f);
  gl().Enable(GL_RASTERIZER_DISCARD);
  gl().NamedFramebufferDrawBuffer(0, GL_NONE);
  gl().NamedFramebufferReadBuffer(0, GL_NONE);
  const auto look = [&] {
    std::vector<GLint> values;
    for (const GLenum name :
         {GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_TEXTURE_BINDING_2D,
          GL_PIXEL_UNPACK_BUFFER_BINDING, GL_PIXEL_PACK_BUFFER_BINDING, GL_UNPACK_ROW_LENGTH,
          GL_UNPACK_ALIGNMENT, GL_PACK_SKIP_ROWS, GL_SCISSOR_TEST, GL_DEPTH_WRITEMASK, GL_STENCIL_WRITEMASK,
          GL_RASTERIZER_DISCARD, GL_DRAW_BUFFER, GL_READ_BUFFER, GL_ATTRIB_STACK_DEPTH, GL_MAP_COLOR}) {
      values.push_back(integer(name));
    }
    GLfloat scale = 0, bias = 0;
    gl().GetFloatv(GL_RED_SCALE, &scale);
    gl().GetFloatv(GL_DEPTH_BIAS, &bias);
    values.insert(values.end(), {GLint(scale * 100), GLint(bias * 100)});
    std::array<GLint, 4> viewport{};
    gl().GetIntegerv(GL_VIEWPORT, viewport.data());
    values.insert(values.end(), viewport.begin(), viewport.end());
    return values;
  };
  const std::vector<GLint> before = look();
  ASSERT_EQ(before[0], GLint(framebuffer));
  ASSERT_EQ(before[2], texture);
  windows.make_current(1, 8, extent);
  EXPECT_EQ(look(), before);
  EXPECT_EQ(shown(), black);
  windows.make_current(1, 7, extent);
  EXPECT_EQ(look(), before);
  EXPECT_EQ(shown(), red);
  gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
  EXPECT_EQ(integer(GL_DRAW_BUFFER), GL_NONE);
  EXPECT_EQ(integer(GL_READ_BUFFER), GL_NONE);
  EXPECT_EQ(integer(GL_SCISSOR_TEST), GL_TRUE);
  expect_no_error();
}

TEST_F(Osmesa, NothingElseGetsIntoAListWhileAWindowChangesItsSize) {
  add(context(1));
  const GLuint list = gl().GenLists(1);
  gl().NewList(list, GL_COMPILE);
  gl().ClearColor(0, 1, 0, 1);
  windows.make_current(1, 0, {64, 48});
  gl().Clear(GL_COLOR_BUFFER_BIT);
  windows.make_current(1, 5, {64, 48});
  windows.make_current(1, 0, {64, 48});
  gl().EndList();
  gl().BindTexture(GL_TEXTURE_2D, 77);
  gl().CallList(list);
  EXPECT_EQ(shown({64, 48}), green);
  EXPECT_EQ(integer(GL_TEXTURE_BINDING_2D), 77);
  EXPECT_EQ(integer(GL_ATTRIB_STACK_DEPTH), 0);
  expect_no_error();
}

TEST_F(Osmesa, AccumulatesInCompatibilityContexts) {
  add(context(1));
  ASSERT_GT(integer(GL_ACCUM_RED_BITS), 0);
  fill(red);
  gl().Accum(GL_LOAD, 1);
  fill(blue);
  gl().Accum(GL_RETURN, 1);
  EXPECT_EQ(shown(), red);
  expect_no_error();
}

class KeptTraces : public testing::TestWithParam<const char*> {};

TEST_P(KeptTraces, ShowTheSameImagesOnOsmesa) {
  const std::string name = GetParam();
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("osmesa.{}.{}", name, getpid());
  spu::Options options;
  options.speed_guard = false;
  options.chain = "driver";
  options.server_opengl = "osmesa";
  const launcher::Played played =
      launcher::play({.trace = fs::path(TRACES) / (name + ".ust"), .save_frames = folder}, options);
  EXPECT_EQ(played.errors, 0U);
  ASSERT_GT(played.frames, 0U);
  for (std::uint64_t frame = 1; frame <= played.frames; ++frame) {
    EXPECT_GE(
        launcher::difference(launcher::read_image(folder / fmt::format("frame_000{}.png", frame)),
                             launcher::read_image(fs::path(EXPECTED) / fmt::format("{}_{}.png", name, frame)))
            .psnr(),
        50)
        << frame;
  }
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Traces, KeptTraces,
                         testing::Values("rgba", "table", "core", "version_1", "max", "under", "bricks",
                                         "preint", "lit"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace understudy::replay_test
