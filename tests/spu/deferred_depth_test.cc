// SPDX-License-Identifier: Apache-2.0
// Depth that substituted slices would have written: it is not drawn if a toolkit merely switches framebuffers,
// but it is available to every reader.
#include "spu/volume/observation/deferred_depth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(DeferredDepth, IsThatOfFramebuffersApart) {
  DeferredDepth depth;
  EXPECT_THAT(depth.add({.framebuffer = 0, .volume = 7}), IsEmpty());
  EXPECT_THAT(depth.add({.framebuffer = 3, .volume = 7, .renderbuffer = 5}), IsEmpty());
  EXPECT_THAT(depth.add({.framebuffer = 3, .volume = 8, .renderbuffer = 5}), IsEmpty());
  EXPECT_THAT(depth.take(1, 0), IsEmpty());
  EXPECT_THAT(depth.take(1, 6), IsEmpty()) << "another renderbuffer";
  EXPECT_THAT(depth.take(3, 0), ElementsAre(7, 8));
  EXPECT_FALSE(depth.empty());
  EXPECT_THAT(depth.take_all(), ElementsAre(7));
  EXPECT_TRUE(depth.empty());
}

TEST(DeferredDepth, IsLookedAtThroughAnotherFramebufferThatSharesIt) {
  DeferredDepth depth;
  depth.add({.framebuffer = 3, .volume = 7, .in_texture = true});
  depth.add({.framebuffer = 4, .volume = 8, .renderbuffer = 5});
  EXPECT_THAT(depth.take_textures(3), IsEmpty());
  EXPECT_THAT(depth.take_textures(4), ElementsAre(7))
      << "it may be sampled while another framebuffer is drawn into";
  EXPECT_THAT(depth.take(6, 5), ElementsAre(8));
}

TEST(DeferredDepth, IsGoneWhereAllOfItIsCleared) {
  DeferredDepth depth;
  depth.add({.framebuffer = 3, .volume = 7, .pixels = {10, 10, 20, 20}});
  EXPECT_THAT(depth.take_cleared(3, volume::Rect{0, 0, 20, 100}), IsEmpty()) << "half of it";
  EXPECT_THAT(depth.take_cleared(4, std::nullopt), IsEmpty()) << "another framebuffer's";
  EXPECT_THAT(depth.take_cleared(3, volume::Rect{10, 10, 20, 20}), ElementsAre(7));
}

TEST(DeferredDepth, IsWatchedInSoManyFramebuffersAndNoMore) {
  DeferredDepth depth;
  for (GLuint i = 0; i < DeferredDepth::most_framebuffers; ++i)
    EXPECT_THAT(depth.add({.framebuffer = i, .volume = 10 + i}), IsEmpty());
  EXPECT_THAT(depth.add({.framebuffer = 99, .volume = 99}), ElementsAre(10)) << "the oldest";
}

/// Two framebuffer objects, as a toolkit has them; the depth of the first is a renderbuffer or a texture.
class Framebuffers {
 public:
  Framebuffers(const DispatchTable& gl, bool depth_in_texture) {
    constexpr int size = GlApplication::size;
    gl.GenFramebuffers(2, names_.data());
    gl.GenRenderbuffers(3, buffers_.data());
    for (std::size_t i = 0; i < 2; ++i) {
      gl.BindFramebuffer(GL_FRAMEBUFFER, names_[i]);
      gl.BindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
      gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, size, size);
      gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers_[i]);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, names_[0]);
    if (depth_in_texture) {
      GLuint texture = 0;
      gl.GenTextures(1, &texture);
      gl.BindTexture(GL_TEXTURE_2D, texture);
      gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT,
                    nullptr);
      gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture, 0);
      gl.BindTexture(GL_TEXTURE_2D, 0);
    } else {
      gl.BindRenderbuffer(GL_RENDERBUFFER, buffers_[2]);
      gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, size, size);
      gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers_[2]);
    }
    EXPECT_EQ(gl.CheckFramebufferStatus(GL_FRAMEBUFFER), GLenum(GL_FRAMEBUFFER_COMPLETE));
  }
  GLuint of_volume() const { return names_[0]; }
  GLuint other() const { return names_[1]; }

 private:
  std::array<GLuint, 2> names_{};
  std::array<GLuint, 3> buffers_{};
};

class DeferredDepthOfFrames : public ::testing::Test {
 protected:
  void SetUp() override {
    app_ = GlApplication::start(Profile::compatibility);
    if (!app_) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
    scene_.set_up(*app_);
    app_->use_chain(true);
  }

  // The dispatch table changes with the phase of the stream, so it is fetched for every call.
  const DispatchTable& gl() const { return app_->gl(); }

  void draw_volume(const Framebuffers& framebuffers) {
    gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffers.of_volume());
    gl().Enable(GL_DEPTH_TEST);
    gl().DepthMask(GL_TRUE);
    scene_.draw(*app_, 25);
  }

  /// Smallest depth in the volume's framebuffer, read bypassing Understudy; then ends the frame.
  float smallest_depth(const Framebuffers& framebuffers) {
    std::vector<float> depth(std::size_t(GlApplication::size) * GlApplication::size);
    const DispatchTable& driver = app_->driver();
    GLint bound = 0;
    driver.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound);
    driver.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers.of_volume());
    driver.ReadPixels(0, 0, GlApplication::size, GlApplication::size, GL_DEPTH_COMPONENT, GL_FLOAT,
                      depth.data());
    driver.BindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound));
    app_->end_frame();
    return *std::min_element(depth.begin(), depth.end());
  }

  /// Draws a frame that ends with another framebuffer bound.
  float smallest_depth_after_frame(const Framebuffers& framebuffers) {
    draw_volume(framebuffers);
    gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffers.of_volume());
    gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffers.other());
    gl().Clear(GL_COLOR_BUFFER_BIT);
    return smallest_depth(framebuffers);
  }

  std::unique_ptr<GlApplication> app_;
  const SliceScene scene_ = immediate_rgba();
};

TEST_F(DeferredDepthOfFrames, IsNotDrawnWhereAToolkitSwitchesFramebuffers) {
  const Framebuffers framebuffers(app_->gl(), /*depth_in_texture=*/false);
  EXPECT_LT(smallest_depth_after_frame(framebuffers), 1) << "the first frame draws it";
  for (std::uint64_t frame = 2; frame <= 4; ++frame) {
    EXPECT_EQ(smallest_depth_after_frame(framebuffers), 1) << "frame " << frame;
    EXPECT_EQ(app_->substituted(), frame) << app_->last_reason();
  }
}

TEST_F(DeferredDepthOfFrames, IsDrawnIntoATextureThatMayBeSampled) {
  const Framebuffers framebuffers(app_->gl(), /*depth_in_texture=*/true);
  for (std::uint64_t frame = 1; frame <= 3; ++frame) {
    EXPECT_LT(smallest_depth_after_frame(framebuffers), 1) << "frame " << frame;
    EXPECT_EQ(app_->substituted(), frame) << app_->last_reason();
  }
}

TEST_F(DeferredDepthOfFrames, IsThereFromTheSecondLookOnInAFramebufferThatIsBoundAgain) {
  const Framebuffers framebuffers(app_->gl(), /*depth_in_texture=*/false);
  for (int frame = 1; frame <= 2; ++frame) smallest_depth_after_frame(framebuffers);
  // Draws into the volume's framebuffer with a depth test and without a clear.
  app_->gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffers.of_volume());
  app_->gl().Enable(GL_DEPTH_TEST);
  app_->gl().Begin(GL_TRIANGLES);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}) app_->gl().Vertex3d(x, y, 0.5);
  app_->gl().End();
  app_->end_frame();
  EXPECT_LT(smallest_depth_after_frame(framebuffers), 1);
}

constexpr const char* reads_a_texel =
    "#version 430\n"
    "layout(local_size_x = 1) in;\n"
    "uniform sampler2D depth;\n"
    "layout(std430, binding = 0) buffer To { float to; };\n"
    "void main() { to = texelFetch(depth, ivec2(48), 0).r; }\n";

/// Nothing is drawn or bound between the volume and the compute shader.
TEST_F(DeferredDepthOfFrames, IsThereForAComputeShaderFromTheSecondFrameOn) {
  const Framebuffers framebuffers(app_->gl(), /*depth_in_texture=*/true);
  const GLuint shader = gl().CreateShader(GL_COMPUTE_SHADER);
  gl().ShaderSource(shader, 1, &reads_a_texel, nullptr);
  gl().CompileShader(shader);
  const GLuint program = gl().CreateProgram();
  gl().AttachShader(program, shader);
  gl().LinkProgram(program);
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer);
  gl().BufferData(GL_SHADER_STORAGE_BUFFER, sizeof(float), nullptr, GL_STATIC_DRAW);
  for (int frame = 1; frame <= 3; ++frame) {
    draw_volume(framebuffers);
    gl().UseProgram(program);
    gl().DispatchCompute(1, 1, 1);
    gl().UseProgram(0);
    EXPECT_LT(smallest_depth(framebuffers), 1) << "frame " << frame;
  }
  EXPECT_EQ(app_->error(), GLenum(GL_NO_ERROR));
  EXPECT_EQ(app_->substituted(), 3U) << app_->last_reason();
}

}  // namespace
}  // namespace understudy::spu::testing
