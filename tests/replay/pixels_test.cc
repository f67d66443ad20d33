// SPDX-License-Identifier: Apache-2.0
// Pixel transfers to OpenGL: whatever the layout in the application's memory, the trace holds the same image.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "replayed.h"

namespace understudy::replay_test {
namespace {

using PixelTransfers = Replayed;

/// Draws a square with the bound texture of `target`.
void draw_textured(const spu::DispatchTable& gl, GLenum target, float left, float depth = 0.5F) {
  gl.TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.Enable(target);
  gl.Begin(GL_QUADS);
  for (const auto& [s, t] : {std::pair(0.0F, 0.0F), {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}}) {
    gl.TexCoord3f(s, t, depth);
    gl.Vertex2f(left + 0.6F * s, -0.8F + 1.6F * t);
  }
  gl.End();
  gl.Disable(target);
}

std::vector<std::uint8_t> noise(std::size_t bytes) {
  std::vector<std::uint8_t> values(bytes);
  std::uint32_t state = 12345;
  for (std::uint8_t& value : values) {
    state = state * 1664525U + 1013904223U;
    value = std::uint8_t(state >> 24);
  }
  return values;
}

TEST_F(PixelTransfers, WithRowLengthSkipsAndAlignment) {
  const auto pixels = noise(std::size_t(40) * 40 * 3);
  gl().PixelStorei(GL_UNPACK_ROW_LENGTH, 21);
  gl().PixelStorei(GL_UNPACK_SKIP_ROWS, 3);
  gl().PixelStorei(GL_UNPACK_SKIP_PIXELS, 5);
  gl().PixelStorei(GL_UNPACK_ALIGNMENT, 8);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, 13, 11, 0, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  draw_textured(gl(), GL_TEXTURE_2D, -0.9F);
  gl().PixelStorei(GL_UNPACK_ALIGNMENT, 2);
  gl().TexSubImage2D(GL_TEXTURE_2D, 0, 2, 1, 7, 9, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  draw_textured(gl(), GL_TEXTURE_2D, -0.1F);
  gl().RasterPos2f(0.5F, -0.5F);
  gl().DrawPixels(15, 12, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  expect_same_images();
}

// Not combined, because Mesa 22.3 then swaps the wrong bytes.
TEST_F(PixelTransfers, WithImagesSkippedInAVolumeOrBytesSwapped) {
  const auto pixels = noise(std::size_t(16) * 16 * 16 * 2);
  gl().PixelStorei(GL_UNPACK_IMAGE_HEIGHT, 9);
  gl().PixelStorei(GL_UNPACK_SKIP_IMAGES, 2);
  gl().PixelStorei(GL_UNPACK_SKIP_ROWS, 1);
  gl().PixelStorei(GL_UNPACK_ROW_LENGTH, 10);
  gl().TexImage3D(GL_TEXTURE_3D, 0, GL_LUMINANCE16, 8, 7, 6, 0, GL_LUMINANCE, GL_UNSIGNED_SHORT, pixels.data());
  draw_textured(gl(), GL_TEXTURE_3D, -0.9F, 0.1F);
  for (const GLenum name :
       {GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SKIP_ROWS, GL_UNPACK_ROW_LENGTH})
    gl().PixelStorei(name, 0);
  gl().PixelStorei(GL_UNPACK_SWAP_BYTES, 1);
  gl().TexImage3D(GL_TEXTURE_3D, 0, GL_LUMINANCE16, 8, 7, 6, 0, GL_LUMINANCE, GL_UNSIGNED_SHORT, pixels.data());
  draw_textured(gl(), GL_TEXTURE_3D, 0.1F, 0.9F);
  expect_same_images();
}

TEST_F(PixelTransfers, FromPixelBuffers) {
  const auto pixels = noise(std::size_t(16) * 16 * 4);
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
  gl().BufferData(GL_PIXEL_UNPACK_BUFFER, GLsizeiptr(pixels.size()), pixels.data(), GL_STREAM_DRAW);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 8, 8, 0, GL_RGBA, GL_UNSIGNED_BYTE, reinterpret_cast<void*>(64));
  gl().TexSubImage2D(GL_TEXTURE_2D, 0, 2, 2, 4, 4, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  draw_textured(gl(), GL_TEXTURE_2D, -0.9F);
  expect_same_images();
}

TEST_F(PixelTransfers, ReadIntoPixelBuffersAndBack) {
  gl().ClearColor(0.3F, 0.6F, 0.9F, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  GLuint buffer = 0;
  gl().GenBuffers(1, &buffer);
  gl().BindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
  gl().BufferData(GL_PIXEL_PACK_BUFFER, 8 * 8 * 4 * 2, nullptr, GL_STREAM_COPY);
  gl().ReadPixels(4, 4, 8, 8, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  const auto pixels = noise(std::size_t(8) * 8 * 4);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 8, 8, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  gl().GetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, reinterpret_cast<void*>(8 * 8 * 4));
  gl().BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 8, 16, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  draw_textured(gl(), GL_TEXTURE_2D, -0.3F);
  expect_same_images();
}

TEST_F(PixelTransfers, OfBitmapsAndStipples) {
  const auto bits = noise(600);
  gl().PixelStorei(GL_UNPACK_LSB_FIRST, 1);
  gl().PixelStorei(GL_UNPACK_SKIP_PIXELS, 3);
  gl().PixelStorei(GL_UNPACK_ROW_LENGTH, 37);
  gl().RasterPos2f(-0.8F, -0.8F);
  gl().Color3f(1, 0.5F, 0.2F);
  gl().Bitmap(30, 13, 1, 2, 12, 5, bits.data());
  gl().Bitmap(11, 40, 0, 0, 0, 0, bits.data());
  gl().PixelStorei(GL_UNPACK_LSB_FIRST, 0);
  gl().PolygonStipple(bits.data());
  gl().Enable(GL_POLYGON_STIPPLE);
  gl().Rectf(-0.1F, -0.1F, 0.9F, 0.9F);
  expect_same_images();
}

TEST_F(PixelTransfers, ReadByTheApplicationAreReadAgain) {
  gl().ClearColor(0.25F, 0.5F, 0.75F, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT);
  gl().Rectf(-0.5F, -0.5F, 0.5F, 0.5F);
  std::vector<std::uint8_t> read(std::size_t(20) * 20 * 4);
  gl().PixelStorei(GL_PACK_ROW_LENGTH, 20);
  gl().ReadPixels(extent.width / 2, extent.height / 2, 20, 20, GL_BGRA, GL_UNSIGNED_BYTE, read.data());
  expect_same_images();
  const Played played = play_back(trace);
  ASSERT_EQ(played.reads.size(), 1U);
  EXPECT_EQ(played.reads[0], read);
}

TEST_F(PixelTransfers, ThroughFramebufferObjects) {
  GLuint texture = 0;
  GLuint framebuffer = 0;
  GLuint depth = 0;
  gl().GenTextures(1, &texture);
  gl().BindTexture(GL_TEXTURE_2D, texture);
  gl().TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 32, 32, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  gl().GenRenderbuffers(1, &depth);
  gl().BindRenderbuffer(GL_RENDERBUFFER, depth);
  gl().RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH24_STENCIL8, 32, 32);
  gl().GenFramebuffers(1, &framebuffer);
  gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  gl().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  gl().FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, depth);
  gl().Viewport(0, 0, 32, 32);
  gl().ClearColor(0.1F, 0.4F, 0.2F, 1);
  gl().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl().Enable(GL_DEPTH_TEST);
  gl().Color3f(1, 0.2F, 0);
  gl().Rectf(-0.5F, -0.9F, 0.3F, 0.4F);
  gl().Disable(GL_DEPTH_TEST);
  gl().BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl().Viewport(0, 0, extent.width, extent.height);
  gl().Color3f(1, 1, 1);
  draw_textured(gl(), GL_TEXTURE_2D, -0.7F);
  gl().BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  gl().BlitFramebuffer(0, 0, 32, 32, 60, 5, 90, 40, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  expect_same_images();
}

}  // namespace
}  // namespace understudy::replay_test
