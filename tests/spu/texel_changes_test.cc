// SPDX-License-Identifier: Apache-2.0
// A texture that changes between frames: only differences are transmitted, and the image equals, bit for bit,
// that of a texture that was loaded with the new texels from the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>
#include <vector>

#include "slice_scenes.h"
#include "volume/texel_box.h"

namespace understudy::spu::testing {
namespace {

using volume::TexelBox;

const TexelBox whole{{0, 0, 0}, {70, 50, 40}};
constexpr std::size_t all_texels = std::size_t{70} * 50 * 40;
constexpr std::uint64_t block_bytes = 16 * 16 * 16;

/// The application's copy of the texels, from which the texture is updated.
template <class Texel>
class Film {
 public:
  Film(GlApplication& app, GLenum internal_format) : app_(app), format_(internal_format), texels_(all_texels) {
    scene_.set_up(app);
    app.gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (std::size_t i = 0; i < texels_.size(); ++i)
      texels_[i] = value(0.5 + 0.5 * std::sin(0.001 * double(i)));
    define();
  }

  static Texel value(double v) { return sizeof(Texel) == 1 ? Texel(255 * v) : Texel(v); }
  static constexpr GLenum type = sizeof(Texel) == 1 ? GL_UNSIGNED_BYTE : GL_FLOAT;

  void fill(const TexelBox& box, std::mt19937& random) {
    const double base = double(random() % 1000) / 999;
    for (int z = box.low[2]; z < box.high[2]; ++z)
      for (int y = box.low[1]; y < box.high[1]; ++y)
        for (int x = box.low[0]; x < box.high[0]; ++x)
          texels_[(z * 50 + y) * 70 + x] = value(base * double(random() % 256) / 255);
  }
  void define() {
    app_.gl().TexImage3D(GL_TEXTURE_3D, 0, GLint(format_), 70, 50, 40, 0, GL_RED, type, texels_.data());
  }
  void upload(const TexelBox& box) {
    std::vector<Texel> part(volume::texels_in(box));
    volume::copy_texels(box, sizeof(Texel), whole, std::as_bytes(std::span(texels_)), box,
                        std::as_writable_bytes(std::span(part)));
    app_.gl().TexSubImage3D(GL_TEXTURE_3D, 0, box.low[0], box.low[1], box.low[2], box.high[0] - box.low[0],
                            box.high[1] - box.low[1], box.high[2] - box.low[2], GL_RED, type, part.data());
  }
  void clear(const TexelBox& box, double v) {
    const Texel clear = value(v);
    for (int z = box.low[2]; z < box.high[2]; ++z)
      for (int y = box.low[1]; y < box.high[1]; ++y)
        for (int x = box.low[0]; x < box.high[0]; ++x) texels_[(z * 50 + y) * 70 + x] = clear;
    GLint texture = 0;
    app_.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
    app_.gl().ClearTexSubImage(GLuint(texture), 0, box.low[0], box.low[1], box.low[2], box.high[0] - box.low[0],
                               box.high[1] - box.low[1], box.high[2] - box.low[2], GL_RED, type, &clear);
  }

  std::vector<float> draw(double angle) {
    scene_.draw(app_, angle);
    auto pixels = app_.read_pixels();
    app_.end_frame();
    return pixels;
  }
  /// Draws with a new texture that has held these texels only.
  std::vector<float> draw_fresh(double angle) {
    GLint texture = 0;
    GLuint fresh = 0;
    app_.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
    app_.gl().GenTextures(1, &fresh);
    app_.gl().BindTexture(GL_TEXTURE_3D, fresh);
    for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      app_.gl().TexParameteri(GL_TEXTURE_3D, name, GL_LINEAR);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
      app_.gl().TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
    define();
    auto pixels = draw(angle);
    app_.gl().BindTexture(GL_TEXTURE_3D, GLuint(texture));
    app_.gl().DeleteTextures(1, &fresh);
    return pixels;
  }

 private:
  GlApplication& app_;
  GLenum format_;
  SliceScene scene_ = client_arrays_table();
  std::vector<Texel> texels_;
};

struct Sent {
  explicit Sent(const GlApplication& app)
      : app_(app), sent_(app.texel_bytes_sent()), left_out_(app.texel_bytes_left_out()) {}
  std::uint64_t bytes() const { return app_.texel_bytes_sent() - sent_; }
  std::uint64_t left_out() const { return app_.texel_bytes_left_out() - left_out_; }

 private:
  const GlApplication& app_;
  std::uint64_t sent_, left_out_;
};

TEST(TexelChanges, OfNothingSendNothing) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  Film<std::uint8_t> film(*app, GL_R8);
  const Sent first(*app);
  const auto before = film.draw(20);
  EXPECT_EQ(first.bytes(), all_texels);
  EXPECT_EQ(first.left_out(), 0U);
  const std::vector<std::function<void()>> uploads = {[&] { film.upload(whole); }, [&] { film.define(); },
                                                      [&] {
                                                        film.upload({{3, 4, 5}, {30, 9, 11}});
                                                      }};
  for (const auto& upload : uploads) {
    const Sent sent(*app);
    upload();
    EXPECT_EQ(film.draw(20), before);
    EXPECT_EQ(sent.bytes(), 0U);
    EXPECT_EQ(sent.left_out(), all_texels);
  }
  EXPECT_EQ(app->substituted(), 4U) << app->last_reason();
}

TEST(TexelChanges, OfACornerSendTheBlocksThatItTouches) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  Film<std::uint8_t> film(*app, GL_R8);
  std::mt19937 random(3);
  auto before = film.draw(20);
  for (const bool all_again : {false, true}) {
    for (const auto& [corner, bytes] : {std::pair{TexelBox{{0, 0, 0}, {9, 16, 12}}, block_bytes},
                                        {TexelBox{{12, 3, 3}, {20, 9, 20}}, 4 * block_bytes},
                                        {TexelBox{{65, 49, 35}, {70, 50, 40}}, std::uint64_t(6 * 2 * 8)}}) {
      film.fill(corner, random);
      film.upload(all_again ? whole : corner);
      const Sent sent(*app);
      const auto after = film.draw(20);
      EXPECT_EQ(sent.bytes(), bytes);
      EXPECT_EQ(sent.left_out(), all_texels - bytes);
      EXPECT_NE(after, before) << "the corner is to be seen";
      before = after;
      EXPECT_EQ(film.draw_fresh(20), after);
    }
  }
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
}

template <class Texel>
void expect_random_changes_right(GLenum internal_format) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const unsigned seed = 40417;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  Film<Texel> film(*app, internal_format);
  film.draw(0);
  for (int frame = 0; frame < 14; ++frame) {
    const Sent sent(*app);
    TexelBox touched;
    for (unsigned change = 0; change < 1 + random() % 20; ++change) {
      TexelBox box;
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = int(random() % unsigned(whole.high[k]));
        box.high[k] = std::min(whole.high[k], box.low[k] + 1 + int(random() % 20));
      }
      touched = volume::enclosing(touched, box);
      if (random() % 4 == 0) {
        film.clear(box, double(random() % 100) / 99);
      } else {
        film.fill(box, random);
        film.upload(random() % 5 == 0 ? whole : box);
      }
    }
    const double angle = 4.0 * frame;
    const auto changed = film.draw(angle);
    EXPECT_LE(sent.bytes() + sent.left_out(),
              std::max<std::uint64_t>(all_texels * sizeof(Texel), sent.bytes()));
    ASSERT_EQ(film.draw_fresh(angle), changed) << "frame " << frame;
  }
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

TEST(TexelChanges, OfAnyKindGiveTheImageOfAFreshTexture) {
  expect_random_changes_right<std::uint8_t>(GL_R8);
}

TEST(TexelChanges, OfFloatsGiveTheImageOfAFreshTexture) {
  expect_random_changes_right<float>(GL_R32F);
}

TEST(TexelChanges, CopiedFromTheFramebufferAreSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  Film<std::uint8_t> film(*app, GL_R8);
  const auto before = film.draw(20);
  app->gl().ClearColor(0.9F, 0.9F, 0.9F, 1);
  app->gl().Clear(GL_COLOR_BUFFER_BIT);
  app->gl().CopyTexSubImage3D(GL_TEXTURE_3D, 0, 20, 20, 21, 2, 2, 10, 10);
  const Sent sent(*app);
  EXPECT_NE(film.draw(20), before);
  EXPECT_EQ(sent.bytes(), block_bytes);
}

/// Makes a texture like the bound one.
GLuint define_another(GlApplication& app, std::uint8_t value, const TexelBox& box) {
  GLint bound = 0;
  GLuint texture = 0;
  app.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &bound);
  app.gl().GenTextures(1, &texture);
  app.gl().BindTexture(GL_TEXTURE_3D, texture);
  // Copying from incomplete textures is not possible.
  app.gl().TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  const std::vector<std::uint8_t> texels(volume::texels_in(box), value);
  app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R8, box.high[0], box.high[1], box.high[2], 0, GL_RED,
                      GL_UNSIGNED_BYTE, texels.data());
  app.gl().BindTexture(GL_TEXTURE_3D, GLuint(bound));
  return texture;
}

GLuint bound_texture(GlApplication& app, GLenum binding) {
  GLint texture = 0;
  app.gl().GetIntegerv(binding, &texture);
  return GLuint(texture);
}

// Only the destination is inspected again, and only the blocks that the copy touches.
TEST(TexelChanges, CopiedFromAnotherTextureConcernTheDestinationAlone) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  if (app->gl().CopyImageSubData == nullptr) GTEST_SKIP() << "this driver cannot copy between textures";
  Film<std::uint8_t> film(*app, GL_R8);
  const auto before = film.draw(20);
  const TexelBox block{{0, 0, 0}, {12, 12, 12}};
  const GLuint source = define_another(*app, 250, block);
  const GLuint bystander = define_another(*app, 0, whole);
  const GLuint volume = bound_texture(*app, GL_TEXTURE_BINDING_3D);
  {
    const Sent sent(*app);
    app->gl().CopyImageSubData(source, GL_TEXTURE_3D, 0, 0, 0, 0, bystander, GL_TEXTURE_3D, 0, 20, 20, 20, 10,
                               10, 10);
    EXPECT_EQ(film.draw(20), before);
    EXPECT_EQ(sent.bytes() + sent.left_out(), 0U) << "nobody reads the volume for that";
  }
  {
    const Sent sent(*app);
    app->gl().CopyImageSubData(source, GL_TEXTURE_3D, 0, 1, 1, 1, volume, GL_TEXTURE_3D, 0, 20, 20, 20, 10, 10,
                               10);
    const auto after = film.draw(20);
    EXPECT_NE(after, before);
    EXPECT_EQ(sent.bytes(), block_bytes);

    std::vector<std::uint8_t> copied(1000, 250);
    app->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 20, 20, 20, 10, 10, 10, GL_RED, GL_UNSIGNED_BYTE, copied.data());
    const Sent nothing(*app);
    EXPECT_EQ(film.draw(20), after) << "uploaded, these texels look the same";
    EXPECT_EQ(nothing.bytes(), 0U);
  }
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

TEST(TexelChanges, CopiedIntoATableAreSeen) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  if (app->gl().CopyImageSubData == nullptr) GTEST_SKIP() << "this driver cannot copy between textures";
  Film<std::uint8_t> film(*app, GL_R8);
  const auto before = film.draw(20);
  app->gl().ActiveTexture(GL_TEXTURE1);
  const GLuint table = bound_texture(*app, GL_TEXTURE_BINDING_1D);
  GLint width = 0;
  GLint format = 0;
  app->gl().GetTexLevelParameteriv(GL_TEXTURE_1D, 0, GL_TEXTURE_WIDTH, &width);
  app->gl().GetTexLevelParameteriv(GL_TEXTURE_1D, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
  ASSERT_GT(width, 0);
  GLuint other = 0;
  app->gl().GenTextures(1, &other);
  app->gl().BindTexture(GL_TEXTURE_1D, other);
  app->gl().TexParameteri(GL_TEXTURE_1D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  app->gl().TexImage1D(GL_TEXTURE_1D, 0, format, width, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                       std::vector<std::uint8_t>(std::size_t(4 * width), 90).data());
  app->gl().BindTexture(GL_TEXTURE_1D, table);
  app->gl().ActiveTexture(GL_TEXTURE0);
  app->gl().CopyImageSubData(other, GL_TEXTURE_1D, 0, 0, 0, 0, table, GL_TEXTURE_1D, 0, 0, 0, 0, width, 1, 1);
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
  EXPECT_NE(film.draw(20), before);
  EXPECT_EQ(app->left(), 0U) << app->last_reason();
}

}  // namespace
}  // namespace understudy::spu::testing
