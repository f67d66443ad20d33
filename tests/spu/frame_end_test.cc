// SPDX-License-Identifier: Apache-2.0
// Whichever command accesses the framebuffer, the volume's image is already there.
//
// A run of slices is held back until something could see its result. Each command here is the first call after
// the slices. Its effect is read bypassing the chain, so that only this call can have ended the run.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <thread>

#include "dispatch/call_id.h"
#include "slice_scenes.h"
#include "spu/chain.h"

namespace understudy::spu::testing {
namespace {

using Image = std::vector<float>;

constexpr int size = GlApplication::size;
constexpr int middle = size / 2;
constexpr double alike = 40;      ///< dB, between the application's own image and Understudy's
constexpr double different = 30;  ///< dB, that an image without the volume must not reach

/// Objects that an application has beside its window: two framebuffers with a texture each, textures of one and
/// of three dimensions, and a buffer. All are made before the slices, so that each command is a single call.
struct Targets {
  std::array<GLuint, 2> framebuffer{};
  std::array<GLuint, 2> texture{};
  GLuint line = 0;
  GLuint layer = 0;
  GLuint buffer = 0;
};

constexpr GLsizeiptr bytes_of_an_image = GLsizeiptr(4 * sizeof(float)) * size * size;

Targets make_targets(const DispatchTable& gl) {
  Targets targets;
  gl.GenFramebuffers(2, targets.framebuffer.data());
  gl.GenTextures(2, targets.texture.data());
  for (std::size_t i = 0; i < 2; ++i) {
    gl.BindTexture(GL_TEXTURE_2D, targets.texture[i]);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, size, size, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer[i]);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, targets.texture[i], 0);
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT);
  }
  gl.BindTexture(GL_TEXTURE_2D, targets.texture[0]);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.GenTextures(1, &targets.line);
  gl.BindTexture(GL_TEXTURE_1D, targets.line);
  gl.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA8, size, 0, GL_RGBA, GL_FLOAT, nullptr);
  gl.CreateTextures(GL_TEXTURE_3D, 1, &targets.layer);
  gl.TextureStorage3D(targets.layer, 1, GL_RGBA8, size, size, 1);
  gl.GenBuffers(1, &targets.buffer);
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, targets.buffer);
  gl.BufferData(GL_PIXEL_PACK_BUFFER, bytes_of_an_image, nullptr, GL_STREAM_READ);
  gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  return targets;
}

void delete_targets(const DispatchTable& gl, const Targets& targets) {
  gl.DeleteFramebuffers(2, targets.framebuffer.data());
  gl.DeleteTextures(2, targets.texture.data());
  gl.DeleteTextures(1, &targets.line);
  gl.DeleteTextures(1, &targets.layer);
  gl.DeleteBuffers(1, &targets.buffer);
}

Image pixels_of(GlApplication& app, GLuint framebuffer) {
  const DispatchTable& gl = app.driver();
  Image pixels(std::size_t(4) * size * size);
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  gl.ReadPixels(0, 0, size, size, GL_RGBA, GL_FLOAT, pixels.data());
  return pixels;
}

Image window(GlApplication& app) {
  return pixels_of(app, 0);
}

Image texels_of(GlApplication& app, GLuint texture, int height = size) {
  Image texels(std::size_t(4) * size * std::size_t(height));
  app.driver().GetTextureImage(texture, 0, GL_RGBA, GL_FLOAT, GLsizei(texels.size() * sizeof(float)),
                               texels.data());
  return texels;
}

enum class Into { window, texture };

struct Command {
  const char* name;
  Into into;  ///< where the slices are drawn
  /// Makes the command, and returns the image that it shows.
  std::function<Image(GlApplication&, const Targets&)> look;
};

/// Made bypassing the chain: making it through the chain would end the run.
GLuint query(GlApplication& app) {
  GLuint name = 0;
  app.driver().GenQueries(1, &name);
  return name;
}

std::vector<Command> ends_and_waits() {
  return {
      {"swap", Into::window,
       [](GlApplication& app, const Targets&) {
         app.end_frame();
         return window(app);
       }},
      {"context that stops being current", Into::window,
       [](GlApplication& app, const Targets&) {
         const bool was_under = Chain::current() != nullptr;
         if (was_under) app.use_chain(false);
         Image image = window(app);
         app.use_chain(was_under);
         return image;
       }},
      {"glFlush", Into::window,
       [](GlApplication& app, const Targets&) {
         app.gl().Flush();
         return window(app);
       }},
      {"glFinish", Into::window,
       [](GlApplication& app, const Targets&) {
         app.gl().Finish();
         return window(app);
       }},
      {"glFenceSync", Into::window,
       [](GlApplication& app, const Targets&) {
         const GLsync fence = app.gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
         app.driver().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
         app.driver().DeleteSync(fence);
         return window(app);
       }},
      {"glClientWaitSync", Into::window,
       [](GlApplication& app, const Targets&) {
         // Made bypassing the chain, like a fence from before the slices: the wait only indicates that the
         // application synchronises.
         const GLsync fence = app.driver().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
         app.gl().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
         app.driver().DeleteSync(fence);
         return window(app);
       }},
      {"glBeginQuery", Into::window,
       [](GlApplication& app, const Targets&) {
         const GLuint samples = query(app);
         app.gl().BeginQuery(GL_SAMPLES_PASSED, samples);
         Image image = window(app);
         app.gl().EndQuery(GL_SAMPLES_PASSED);
         GLuint passed = 1;
         app.gl().GetQueryObjectuiv(samples, GL_QUERY_RESULT, &passed);
         EXPECT_EQ(passed, 0U) << "the query began after the slices";
         app.driver().DeleteQueries(1, &samples);
         return image;
       }},
      {"glQueryCounter", Into::window,
       [](GlApplication& app, const Targets&) {
         const GLuint time = query(app);
         app.gl().QueryCounter(time, GL_TIMESTAMP);
         Image image = window(app);
         app.driver().DeleteQueries(1, &time);
         return image;
       }},
      {"glGetError", Into::window,
       [](GlApplication& app, const Targets&) {
         EXPECT_EQ(app.gl().GetError(), GLenum(GL_NO_ERROR));
         return window(app);
       }},
  };
}

std::vector<Command> reads_and_copies() {
  return {
      {"glReadPixels", Into::window, [](GlApplication& app, const Targets&) { return app.read_pixels(); }},
      {"glReadnPixels", Into::window,
       [](GlApplication& app, const Targets&) {
         Image pixels(std::size_t(4) * size * size);
         app.gl().ReadnPixels(0, 0, size, size, GL_RGBA, GL_FLOAT, GLsizei(pixels.size() * sizeof(float)),
                              pixels.data());
         return pixels;
       }},
      {"glMapBuffer after glReadPixels into it", Into::window,
       [](GlApplication& app, const Targets& targets) {
         Image pixels(std::size_t(4) * size * size);
         app.gl().BindBuffer(GL_PIXEL_PACK_BUFFER, targets.buffer);
         app.gl().ReadPixels(0, 0, size, size, GL_RGBA, GL_FLOAT, nullptr);
         const auto* mapped = static_cast<const float*>(app.gl().MapBuffer(GL_PIXEL_PACK_BUFFER, GL_READ_ONLY));
         if (mapped != nullptr) pixels.assign(mapped, mapped + pixels.size());
         app.gl().UnmapBuffer(GL_PIXEL_PACK_BUFFER);
         app.gl().BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
         return pixels;
       }},
      {"glCopyTexImage1D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTexImage1D(GL_TEXTURE_1D, 0, GL_RGBA8, 0, middle, size, 0);
         return texels_of(app, targets.line, 1);
       }},
      {"glCopyTexSubImage1D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTexSubImage1D(GL_TEXTURE_1D, 0, 0, 0, middle, size);
         return texels_of(app, targets.line, 1);
       }},
      {"glCopyTexImage2D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 0, 0, size, size, 0);
         return texels_of(app, targets.texture[0]);
       }},
      {"glCopyTexSubImage2D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, size, size);
         return texels_of(app, targets.texture[0]);
       }},
      {"glCopyTextureSubImage2D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTextureSubImage2D(targets.texture[1], 0, 0, 0, 0, 0, size, size);
         return texels_of(app, targets.texture[1]);
       }},
      {"glCopyTextureSubImage3D", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().CopyTextureSubImage3D(targets.layer, 0, 0, 0, 0, 0, 0, size, size);
         return texels_of(app, targets.layer);
       }},
      {"glCopyPixels", Into::window,
       [](GlApplication& app, const Targets&) {
         // The raster position was never set, so it is the window's corner.
         app.gl().CopyPixels(middle, 0, middle, size, GL_COLOR);
         return window(app);
       }},
      {"glBlitFramebuffer", Into::window,
       [](GlApplication& app, const Targets&) {
         app.gl().BlitFramebuffer(middle, 0, size, size, 0, 0, middle, size, GL_COLOR_BUFFER_BIT, GL_NEAREST);
         return window(app);
       }},
      {"glBlitNamedFramebuffer", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().BlitNamedFramebuffer(0, targets.framebuffer[1], 0, 0, size, size, 0, 0, size, size,
                                       GL_COLOR_BUFFER_BIT, GL_NEAREST);
         return pixels_of(app, targets.framebuffer[1]);
       }},
  };
}

std::vector<Command> changes_of_the_framebuffer() {
  return {
      {"glBindFramebuffer", Into::window,
       [](GlApplication& app, const Targets& targets) {
         app.gl().BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer[1]);
         Image image = window(app);
         app.driver().BindFramebuffer(GL_FRAMEBUFFER, 0);
         return image;
       }},
      {"glClear of a part", Into::window,
       [](GlApplication& app, const Targets&) {
         app.gl().Scissor(0, 0, middle, size);
         app.gl().Enable(GL_SCISSOR_TEST);
         app.gl().ClearColor(0, 1, 0, 1);
         app.gl().Clear(GL_COLOR_BUFFER_BIT);
         app.gl().Disable(GL_SCISSOR_TEST);
         return window(app);
       }},
      {"glClearBufferfv", Into::window,
       [](GlApplication& app, const Targets&) {
         const std::array<float, 4> green{0, 1, 0, 1};
         app.gl().Scissor(0, 0, middle, size);
         app.gl().Enable(GL_SCISSOR_TEST);
         app.gl().ClearBufferfv(GL_COLOR, 0, green.data());
         app.gl().Disable(GL_SCISSOR_TEST);
         return window(app);
       }},
      {"glViewport", Into::window,
       [](GlApplication& app, const Targets&) {
         app.gl().Viewport(0, 0, 7, 5);
         return window(app);
       }},
      {"glDrawBuffer", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().DrawBuffer(GL_NONE);
         Image image = pixels_of(app, targets.framebuffer[0]);
         app.driver().DrawBuffer(GL_COLOR_ATTACHMENT0);
         return image;
       }},
      {"glDrawBuffers", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         const GLenum none = GL_NONE;
         const GLenum first = GL_COLOR_ATTACHMENT0;
         app.gl().DrawBuffers(1, &none);
         Image image = pixels_of(app, targets.framebuffer[0]);
         app.driver().DrawBuffers(1, &first);
         return image;
       }},
      {"glNamedFramebufferDrawBuffer", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().NamedFramebufferDrawBuffer(targets.framebuffer[0], GL_NONE);
         Image image = pixels_of(app, targets.framebuffer[0]);
         app.driver().NamedFramebufferDrawBuffer(targets.framebuffer[0], GL_COLOR_ATTACHMENT0);
         return image;
       }},
      {"glFramebufferTexture2D", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, 0, 0);
         Image image = texels_of(app, targets.texture[0]);
         app.driver().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                                           targets.texture[0], 0);
         return image;
       }},
      {"glFramebufferTexture", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, 0, 0);
         Image image = texels_of(app, targets.texture[0]);
         app.driver().FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, targets.texture[0], 0);
         return image;
       }},
      {"glNamedFramebufferTexture", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().NamedFramebufferTexture(targets.framebuffer[0], GL_COLOR_ATTACHMENT0, 0, 0);
         Image image = texels_of(app, targets.texture[0]);
         app.driver().NamedFramebufferTexture(targets.framebuffer[0], GL_COLOR_ATTACHMENT0, targets.texture[0],
                                              0);
         return image;
       }},
      {"glDeleteFramebuffers", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().DeleteFramebuffers(1, targets.framebuffer.data());
         return texels_of(app, targets.texture[0]);
       }},
  };
}

std::vector<Command> looks_at_an_attachment() {
  return {
      {"glGetTexImage", Into::texture,
       [](GlApplication& app, const Targets&) {
         Image texels(std::size_t(4) * size * size);
         app.gl().GetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, texels.data());
         return texels;
       }},
      {"glGetTextureImage", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         Image texels(std::size_t(4) * size * size);
         app.gl().GetTextureImage(targets.texture[0], 0, GL_RGBA, GL_FLOAT,
                                  GLsizei(texels.size() * sizeof(float)), texels.data());
         return texels;
       }},
      {"glGetTextureSubImage", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         Image texels(std::size_t(4) * size * size);
         app.gl().GetTextureSubImage(targets.texture[0], 0, 0, 0, 0, size, size, 1, GL_RGBA, GL_FLOAT,
                                     GLsizei(texels.size() * sizeof(float)), texels.data());
         return texels;
       }},
      {"quad with it as a texture", Into::texture,
       [](GlApplication& app, const Targets& targets) {
         app.gl().BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer[1]);
         const DispatchTable& gl = app.gl();
         gl.Disable(GL_TEXTURE_3D);
         gl.Disable(GL_BLEND);
         gl.Enable(GL_TEXTURE_2D);
         gl.TexEnvi(GL_TEXTURE_ENV, GL_TEXTURE_ENV_MODE, GL_REPLACE);
         for (const GLenum matrix : {GL_PROJECTION, GL_MODELVIEW}) {
           gl.MatrixMode(matrix);
           gl.LoadIdentity();
         }
         gl.Begin(GL_QUADS);
         for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
           gl.TexCoord2i(x, y);
           gl.Vertex2i(2 * x - 1, 2 * y - 1);
         }
         gl.End();
         gl.Disable(GL_TEXTURE_2D);
         return pixels_of(app, targets.framebuffer[1]);
       }},
  };
}

/// Clears, draws up to the last slice (or no volume), and makes the command.
Image frame(GlApplication& app, const SliceScene& scene, const Command& command, bool volume = true) {
  const Targets targets = make_targets(app.gl());
  if (command.into == Into::texture) app.gl().BindFramebuffer(GL_FRAMEBUFFER, targets.framebuffer[0]);
  if (volume) {
    scene.draw_to_the_last_slice(app, 25);
  } else {
    SliceScene nothing = scene;
    nothing.slices = [](GlApplication&, double) {};
    nothing.draw_to_the_last_slice(app, 25);
  }
  Image image = command.look(app, targets);
  app.driver().BindFramebuffer(GL_FRAMEBUFFER, 0);
  scene.tidy_up(app);
  app.end_frame();
  delete_targets(app.gl(), targets);
  return image;
}

class Commands : public ::testing::TestWithParam<Command> {};

TEST_P(Commands, ShowTheImage) {
  const Command& command = GetParam();
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  app->use_chain(false);
  const Image bare = frame(*app, scene, command);
  EXPECT_LT(psnr(frame(*app, scene, command, false), bare), different)
      << "the volume cannot be seen there: the test tests nothing";
  app->use_chain(true);
  for (std::uint64_t i = 1; i <= 2; ++i) {
    const double likeness = psnr(frame(*app, scene, command), bare);
    std::printf("%s, frame %d: %.1f dB\n", command.name, int(i), likeness);
    EXPECT_GE(likeness, alike) << "frame " << i;
    EXPECT_EQ(app->substituted(), i) << app->last_reason();
  }
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

std::string name_of_command(const ::testing::TestParamInfo<Command>& info) {
  std::string name = info.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Ends, Commands, ::testing::ValuesIn(ends_and_waits()), name_of_command);
INSTANTIATE_TEST_SUITE_P(Reads, Commands, ::testing::ValuesIn(reads_and_copies()), name_of_command);
INSTANTIATE_TEST_SUITE_P(Changes, Commands, ::testing::ValuesIn(changes_of_the_framebuffer()), name_of_command);
INSTANTIATE_TEST_SUITE_P(Attachments, Commands, ::testing::ValuesIn(looks_at_an_attachment()), name_of_command);

/// The commands above are representative: while a run is open, every command that does not add to it is
/// intercepted.
TEST(OpenRun, IsClosedByEveryCallThatAddsNothing) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const DispatchTable& deferring = Chain::current()->head(Phase::deferring);
  for (std::size_t i = 0; i < call_count; ++i) {
    const CallId call = CallId(i);
    if (slot(app->driver(), call) == nullptr) continue;
    EXPECT_NE(slot(deferring, call), slot(app->driver(), call)) << call_name(call);
  }
}

/// The objects that the slices were drawn with may be deleted or changed immediately afterwards.
struct Loss {
  const char* name;
  SliceScene (*scene)();
  void (*lose)(const DispatchTable& gl, const DispatchTable& driver);
};

GLuint bound(const DispatchTable& driver, GLenum binding) {
  GLint name = 0;
  driver.GetIntegerv(binding, &name);
  return GLuint(name);
}

class Losses : public ::testing::TestWithParam<Loss> {
 protected:
  /// In a separate application, since the loss changes it.
  static Image lost_after_the_slices(bool under) {
    auto app = GlApplication::start(GetParam().scene().profile);
    if (!app) return {};
    const SliceScene scene = GetParam().scene();
    scene.set_up(*app);
    app->use_chain(under);
    scene.draw_to_the_last_slice(*app, 25);
    GetParam().lose(app->gl(), app->driver());
    Image image = window(*app);
    EXPECT_EQ(app->substituted(), under ? 1U : 0U) << app->last_reason();
    EXPECT_EQ(app->left(), 0U) << app->last_reason();
    scene.tidy_up(*app);
    app->end_frame();
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
    return image;
  }
};

TEST_P(Losses, LeaveTheImage) {
  const Image bare = lost_after_the_slices(false);
  if (bare.empty()) GTEST_SKIP() << "no EGL context here";
  const double likeness = psnr(lost_after_the_slices(true), bare);
  std::printf("%s: %.1f dB\n", GetParam().name, likeness);
  EXPECT_GE(likeness, alike);
}

INSTANTIATE_TEST_SUITE_P(
    Of, Losses,
    ::testing::Values(Loss{"texture", immediate_rgba,
                           [](const DispatchTable& gl, const DispatchTable& driver) {
                             const GLuint volume = bound(driver, GL_TEXTURE_BINDING_3D);
                             gl.DeleteTextures(1, &volume);
                           }},
                      Loss{"texels", immediate_rgba,
                           [](const DispatchTable& gl, const DispatchTable&) {
                             const std::vector<std::uint8_t> white(std::size_t(4) * 8 * 8 * 8, 255);
                             gl.TexSubImage3D(GL_TEXTURE_3D, 0, 4, 4, 4, 8, 8, 8, GL_RGBA, GL_UNSIGNED_BYTE,
                                              white.data());
                           }},
                      Loss{"list", display_list_texgen,
                           [](const DispatchTable& gl, const DispatchTable&) { gl.DeleteLists(1, 1); }},
                      Loss{"matrix", immediate_rgba,
                           [](const DispatchTable& gl, const DispatchTable&) { gl.LoadIdentity(); }},
                      Loss{"program", client_arrays_table,
                           [](const DispatchTable& gl, const DispatchTable& driver) {
                             gl.DeleteProgram(bound(driver, GL_CURRENT_PROGRAM));
                           }},
                      Loss{"uniform", vertex_shader_varying,
                           [](const DispatchTable& gl, const DispatchTable& driver) {
                             const std::array<GLfloat, 16> nothing{};
                             const GLint camera =
                                 driver.GetUniformLocation(bound(driver, GL_CURRENT_PROGRAM), "camera");
                             gl.UniformMatrix4fv(camera, 1, GL_FALSE, nothing.data());
                           }},
                      Loss{"buffer", core_batched,
                           [](const DispatchTable& gl, const DispatchTable& driver) {
                             const GLuint buffer = bound(driver, GL_ARRAY_BUFFER_BINDING);
                             gl.DeleteBuffers(1, &buffer);
                           }},
                      Loss{"vertices", core_batched,
                           [](const DispatchTable& gl, const DispatchTable&) {
                             const std::vector<GLfloat> elsewhere(300, 5.0F);
                             gl.BufferSubData(GL_ARRAY_BUFFER, 0, 1200, elsewhere.data());
                           }},
                      Loss{"vertex_array", core_batched,
                           [](const DispatchTable& gl, const DispatchTable& driver) {
                             const GLuint array = bound(driver, GL_VERTEX_ARRAY_BINDING);
                             gl.DeleteVertexArrays(1, &array);
                           }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(OtherThreads, SeeInASharedTextureWhatWasDrawnBeforeTheFence) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  const Command in_another_thread{
      "another thread", Into::texture, [](GlApplication& first, const Targets& targets) {
        const GLsync fence = first.gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
        first.gl().Flush();
        Image texels(std::size_t(4) * size * size);
        const bool under = Chain::current() != nullptr;
        std::thread([&] {
          const auto second = first.start_companion();
          ASSERT_TRUE(second);
          second->use_chain(under);
          second->gl().ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
          second->gl().BindTexture(GL_TEXTURE_2D, targets.texture[0]);
          second->gl().GetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, texels.data());
        }).join();
        first.driver().DeleteSync(fence);
        return texels;
      }};
  app->use_chain(false);
  const Image bare = frame(*app, scene, in_another_thread);
  EXPECT_LT(psnr(frame(*app, scene, in_another_thread, false), bare), different);
  app->use_chain(true);
  for (std::uint64_t i = 1; i <= 2; ++i) {
    EXPECT_GE(psnr(frame(*app, scene, in_another_thread), bare), alike) << "frame " << i;
    EXPECT_EQ(app->substituted(), i) << app->last_reason();
  }
}

/// The read is the first call after the slices in every frame. The first frame draws the depth because it is
/// the first; later frames draw it because a read was seen before.
TEST(Depth, IsThereForAReadRightAfterTheSlices) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  const auto depth = [&](bool under) {
    app->use_chain(under);
    app->gl().Enable(GL_DEPTH_TEST);
    app->gl().DepthMask(GL_TRUE);
    scene.draw_to_the_last_slice(*app, 25);
    Image read = app->read_depth();
    scene.tidy_up(*app);
    app->end_frame();
    return read;
  };
  const Image bare = depth(false);
  EXPECT_LT(*std::min_element(bare.begin(), bare.end()), 1) << "the slices write no depth";
  for (std::uint64_t i = 1; i <= 3; ++i) {
    EXPECT_EQ(depth(true), bare) << "frame " << i;
    EXPECT_EQ(app->substituted(), i) << app->last_reason();
  }
}

/// Queries that count drawing would count Understudy's, so such slices are not substituted.
TEST(Queries, AroundTheSlicesCountTheApplicationsOwn) {
  for (const GLenum target :
       {GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED_CONSERVATIVE, GL_PRIMITIVES_GENERATED,
        GL_VERTICES_SUBMITTED, GL_CLIPPING_INPUT_PRIMITIVES, GL_FRAGMENT_SHADER_INVOCATIONS}) {
    auto app = GlApplication::start(Profile::compatibility);
    if (!app) GTEST_SKIP() << "no EGL context here";
    const SliceScene scene = vertex_shader_varying();
    scene.set_up(*app);
    const auto counted = [&](bool under) {
      app->use_chain(under);
      GLuint name = 0;
      GLuint count = 0;
      app->gl().GenQueries(1, &name);
      app->gl().BeginQuery(target, name);
      scene.draw_to_the_last_slice(*app, 25);
      app->gl().EndQuery(target);
      scene.tidy_up(*app);
      app->gl().GetQueryObjectuiv(name, GL_QUERY_RESULT, &count);
      app->gl().DeleteQueries(1, &name);
      app->end_frame();
      return count;
    };
    const GLuint alone = counted(false);
    EXPECT_GT(alone, 0U) << "query " << target << " counts nothing: the test tests nothing";
    EXPECT_EQ(counted(true), alone) << "query " << target;
    EXPECT_EQ(counted(true), alone) << "query " << target;
    EXPECT_EQ(app->left(), 2U) << "query " << target;
    EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR)) << "query " << target;
  }
}

}  // namespace
}  // namespace understudy::spu::testing
