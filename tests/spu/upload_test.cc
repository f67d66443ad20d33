// SPDX-License-Identifier: Apache-2.0
// For every way and format of upload, the volume that is drawn has the uploaded texels; images are compared
// with the emulation in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "emulated_scenes.h"
#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

/// Differs from the field that the scenes load, so that an image of the latter is detected.
std::vector<std::uint8_t> other_field() {
  std::vector<std::uint8_t> texels = Blob().texels();
  std::reverse(texels.begin(), texels.end());
  return texels;
}

void sample_linearly(const DispatchTable& gl) {
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
}

void bind_new_texture(const DispatchTable& gl) {
  GLuint texture = 0;
  gl.GenTextures(1, &texture);
  gl.BindTexture(GL_TEXTURE_3D, texture);
  sample_linearly(gl);
}

constexpr Blob blob;

std::vector<double> from_0_to_1(const std::vector<std::uint8_t>& texels) {
  return texels_of(texels, [](int s) { return std::array{s / 255.0}; });
}

/// What the texture holds in the end.
std::vector<double> the_other_field() {
  return from_0_to_1(other_field());
}

struct Way {
  const char* name;
  std::function<void(GlApplication&)> upload;  ///< into the texture that is bound afterwards
  std::function<std::vector<double>()> held = the_other_field;
  bool changes = true;  ///< false: the scene's own volume is kept
};

/// Truncation error of 16-bit floats just below 1: ten bits of mantissa, counted from one half.
constexpr double half_step = 1.0 / (1 << 11);

/// The clear colour of scene.draw().
constexpr emulation::Colour backdrop{0.1F, 0.2F, 0.3F, 0};

void define(const DispatchTable& gl, const void* texels) {
  gl.TexImage3D(GL_TEXTURE_3D, 0, GL_LUMINANCE8, blob.x, blob.y, blob.z, 0, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                texels);
}

void fill(const DispatchTable& gl, int first, int slices, const void* texels) {
  gl.TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, first, blob.x, blob.y, slices, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                   texels);
}

std::vector<Way> ways() {
  return {
      {"Whole", [](GlApplication& app) { define(app.gl(), other_field().data()); }},
      {"SliceBySlice",
       [](GlApplication& app) {
         const auto texels = other_field();
         define(app.gl(), nullptr);
         for (int z = 0; z < blob.z; ++z) fill(app.gl(), z, 1, texels.data() + z * blob.x * blob.y);
       }},
      {"WholeAndThenAllOfItAgain",
       [](GlApplication& app) {
         define(app.gl(), Blob().texels().data());
         fill(app.gl(), 0, blob.z, other_field().data());
       }},
      {"IntoImmutableStorage",
       [](GlApplication& app) {
         bind_new_texture(app.gl());
         app.gl().TexStorage3D(GL_TEXTURE_3D, 1, GL_LUMINANCE8, blob.x, blob.y, blob.z);
         if (app.error() != GL_NO_ERROR) app.gl().TexStorage3D(GL_TEXTURE_3D, 1, GL_R8, blob.x, blob.y, blob.z);
         GLint base = 0;
         app.gl().GetTexLevelParameteriv(GL_TEXTURE_3D, 0, GL_TEXTURE_LUMINANCE_SIZE, &base);
         app.gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, blob.x, blob.y, blob.z,
                                base != 0 ? GL_LUMINANCE : GL_RED, GL_UNSIGNED_BYTE, other_field().data());
       }},
      {"ByDirectStateAccess",
       [](GlApplication& app) {
         GLuint texture = 0;
         app.gl().CreateTextures(GL_TEXTURE_3D, 1, &texture);
         app.gl().TextureStorage3D(texture, 1, GL_R8, blob.x, blob.y, blob.z);
         app.gl().TextureSubImage3D(texture, 0, 0, 0, 0, blob.x, blob.y, blob.z, GL_RED, GL_UNSIGNED_BYTE,
                                    Blob().texels().data());
         app.gl().BindTextureUnit(0, texture);
         sample_linearly(app.gl());
       },
       blob_values, false},
      {"FromABuffer",
       [](GlApplication& app) {
         const auto texels = other_field();
         GLuint buffer = 0;
         app.gl().GenBuffers(1, &buffer);
         app.gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
         app.gl().BufferData(GL_PIXEL_UNPACK_BUFFER, GLsizeiptr(texels.size()), texels.data(), GL_STREAM_DRAW);
         define(app.gl(), nullptr);  // offset 0 of the buffer
         app.gl().BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
       }},
      {"FromAPartOfALargerArray",
       [](GlApplication& app) {
         constexpr int row = blob.x + 5, rows = blob.y + 3;
         const auto texels = other_field();
         std::vector<std::uint8_t> larger(std::size_t(row * rows * (blob.z + 1)), 77);
         for (int z = 0; z < blob.z; ++z) {
           for (int y = 0; y < blob.y; ++y) {
             std::copy_n(texels.data() + (z * blob.y + y) * blob.x, blob.x,
                         larger.data() + ((z + 1) * rows + y + 2) * row + 4);
           }
         }
         const std::vector<std::pair<GLenum, GLint>> layout = {{GL_UNPACK_ROW_LENGTH, row},
                                                               {GL_UNPACK_IMAGE_HEIGHT, rows},
                                                               {GL_UNPACK_SKIP_PIXELS, 4},
                                                               {GL_UNPACK_SKIP_ROWS, 2},
                                                               {GL_UNPACK_SKIP_IMAGES, 1}};
         for (const auto& [name, value] : layout) app.gl().PixelStorei(name, value);
         define(app.gl(), larger.data());
         for (const auto& [name, value] : layout) app.gl().PixelStorei(name, 0);
       }},
      {"CopiedFromTheFramebuffer",
       [](GlApplication& app) {
         const auto texels = other_field();
         define(app.gl(), nullptr);
         for (int z = 0; z < blob.z; ++z) {
           app.gl().WindowPos2i(3, 4);
           app.gl().DrawPixels(blob.x, blob.y, GL_LUMINANCE, GL_UNSIGNED_BYTE,
                               texels.data() + z * blob.x * blob.y);
           app.gl().CopyTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, z, 3, 4, blob.x, blob.y);
         }
       }},
      {"CopiedFromAnotherTexture",
       [](GlApplication& app) {
         GLint source = 0;
         define(app.gl(), other_field().data());
         app.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &source);
         bind_new_texture(app.gl());
         define(app.gl(), nullptr);
         GLint target = 0;
         app.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &target);
         app.gl().CopyImageSubData(GLuint(source), GL_TEXTURE_3D, 0, 0, 0, 0, GLuint(target), GL_TEXTURE_3D, 0,
                                   0, 0, 0, blob.x, blob.y, blob.z);
       }},
      {"PartlyCleared",
       [](GlApplication& app) {
         define(app.gl(), other_field().data());
         GLint texture = 0;
         app.gl().GetIntegerv(GL_TEXTURE_BINDING_3D, &texture);
         const std::uint8_t grey = 120;
         app.gl().ClearTexSubImage(GLuint(texture), 0, 4, 4, 4, 9, 9, 9, GL_LUMINANCE, GL_UNSIGNED_BYTE, &grey);
       },
       [] {
         std::vector<double> values = the_other_field();
         for (int z = 4; z < 13; ++z)
           for (int y = 4; y < 13; ++y)
             for (int x = 4; x < 13; ++x) values[(z * blob.y + y) * blob.x + x] = 120 / 255.0;
         return values;
       }},
      {"WithABorder",
       [](GlApplication& app) {
         std::vector<std::uint8_t> bordered(std::size_t((blob.x + 2) * (blob.y + 2) * (blob.z + 2)), 200);
         const auto texels = other_field();
         for (int z = 0; z < blob.z; ++z) {
           for (int y = 0; y < blob.y; ++y) {
             std::copy_n(texels.data() + (z * blob.y + y) * blob.x, blob.x,
                         bordered.data() + ((z + 1) * (blob.y + 2) + y + 1) * (blob.x + 2) + 1);
           }
         }
         app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_LUMINANCE8, blob.x + 2, blob.y + 2, blob.z + 2, 1,
                             GL_LUMINANCE, GL_UNSIGNED_BYTE, bordered.data());
       }},
      {"BesideADecoyOnAnotherUnit",
       [](GlApplication& app) {
         define(app.gl(), other_field().data());
         app.gl().ActiveTexture(GL_TEXTURE2);
         bind_new_texture(app.gl());
         const std::vector<std::uint8_t> noise(512, 255);
         app.gl().TexImage3D(GL_TEXTURE_3D, 0, GL_R8, 8, 8, 8, 0, GL_RED, GL_UNSIGNED_BYTE, noise.data());
         app.gl().ActiveTexture(GL_TEXTURE0);
       }},
  };
}

class Uploads : public ::testing::TestWithParam<std::tuple<Way, bool>> {};

TEST_P(Uploads, AreSeen) {
  const auto& [way, drawn_before] = GetParam();
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here; install libegl1 and libgl1-mesa-dri";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  app->gl().PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  const auto drawn = app->substituted();
  EXPECT_EQ(drawn, 1U);
  if (!drawn_before) bind_new_texture(app->gl());
  way.upload(*app);
  ASSERT_EQ(app->error(), GLenum(GL_NO_ERROR));
  scene.draw(*app, 10);
  EXPECT_EQ(app->substituted(), drawn + 1) << app->last_reason();
  const emulation::Image meant = shown_in_bytes(frame_of({table_cube(way.held(), 10)}, backdrop));
  expect_within(way.name, meant, app->read_pixels());
  if (way.changes) {
    EXPECT_GT(channels_outside(meant, before), 500) << "the upload changes nothing: the test tests nothing";
  }
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

INSTANTIATE_TEST_SUITE_P(Of, Uploads, ::testing::Combine(::testing::ValuesIn(ways()), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "IntoATextureThatWasDrawn" : "IntoANewTexture");
                         });

TEST(UploadsOf, TheSameTextureInAnotherFormat) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  std::vector<float> texels;
  for (const std::uint8_t s : other_field()) texels.push_back(float(s) / 255);
  std::uint64_t drawn = 0;
  for (const GLenum format : {GL_R16F, GL_R32F, GL_R8, GL_LUMINANCE16, GL_R32F}) {
    app->gl().TexImage3D(GL_TEXTURE_3D, 0, GLint(format), blob.x, blob.y, blob.z, 0, GL_RED, GL_FLOAT,
                         texels.data());
    scene.draw(*app, 10);
    EXPECT_EQ(app->substituted(), ++drawn) << app->last_reason();
    emulation::Precision precision = emulation::ours;
    if (format == GL_R16F) precision.value += half_step;
    expect_within("another format",
                  shown_in_bytes(frame_of({table_cube(the_other_field(), 10)}, backdrop), precision),
                  app->read_pixels());
  }
}

TEST(UploadsOf, AProxyAreQuestions) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  scene.draw(*app, 10);
  const auto before = app->read_pixels();
  for (const int edge : {64, 1 << 20}) {
    app->gl().TexImage3D(GL_PROXY_TEXTURE_3D, 0, GL_RGBA32F, edge, edge, edge, 0, GL_RGBA, GL_FLOAT, nullptr);
    GLint width = -1;
    app->gl().GetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &width);
    EXPECT_EQ(width, edge == 64 ? 64 : 0);
    scene.draw(*app, 10);
    EXPECT_EQ(app->read_pixels(), before);
  }
  EXPECT_EQ(app->substituted(), 3U) << app->last_reason();
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

TEST(UploadsOf, PaddingAreNoVolume) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = display_list_texgen();
  scene.set_up(*app);
  std::vector<std::uint8_t> padded(std::size_t{32} * 32 * 32, 255);
  const auto texels = other_field();
  for (int z = 0; z < blob.z; ++z) {
    for (int y = 0; y < blob.y; ++y)
      std::copy_n(texels.data() + (z * blob.y + y) * blob.x, blob.x, padded.data() + (z * 32 + y) * 32);
  }
  app->gl().TexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, 32, 32, 32, GL_LUMINANCE, GL_UNSIGNED_BYTE, padded.data());
  scene.draw(*app, 25);
  const auto under = app->read_pixels();
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  app->use_chain(false);
  scene.draw(*app, 25);
  std::printf("padded with full texels: %.1f dB\n", psnr(under, app->read_pixels()));
  EXPECT_GE(psnr(under, app->read_pixels()), 40);
}

/// Fragment colour before multiplication by the primary colour, for a texel with all channels s (alpha of four
/// channels: a fifth of s).
enum class Base { alpha, luminance, intensity, red, colours };

std::array<double, 4> of_base(Base base, double s, double alpha) {
  switch (base) {
    case Base::alpha:
      return {1, 1, 1, s};
    case Base::luminance:
      return {s, s, s, 1};
    case Base::intensity:
      return {s, s, s, s};
    case Base::red:
      return {s, 0, 0, 1};
    case Base::colours:
      return {s, s, s, alpha};
  }
  return {};
}

struct Format {
  const char* name;
  GLenum internal_format;
  GLenum format;
  const char* reason;  ///< why it is refused; null: it is substituted
  Base base = Base::colours;
  double step = 0;  ///< precision of the stored format
};

class Formats : public ::testing::TestWithParam<Format> {};

TEST_P(Formats, AreDrawnRightOrLeftBitIdentical) {
  const Format& format = GetParam();
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = immediate_rgba();
  scene.set_up(*app);
  const std::size_t components = format.format == GL_RGBA              ? 4
                                 : format.format == GL_RGB             ? 3
                                 : format.format == GL_LUMINANCE_ALPHA ? 2
                                                                       : 1;
  std::vector<float> texels;
  for (const std::uint8_t s : other_field()) {
    for (std::size_t c = 0; c < components; ++c) texels.push_back(float(s) / 255 / (c == 3 ? 5 : 1));
  }
  app->gl().TexImage3D(GL_TEXTURE_3D, 0, GLint(format.internal_format), blob.x, blob.y, blob.z, 0,
                       format.format, GL_FLOAT, texels.data());
  ASSERT_EQ(app->error(), GLenum(GL_NO_ERROR));
  scene.draw(*app, 30);
  const auto under = app->read_pixels();
  if (format.reason != nullptr) {
    app->use_chain(false);
    scene.draw(*app, 30);
    EXPECT_EQ(app->substituted(), 0U);
    EXPECT_EQ(app->last_reason(), format.reason);
    EXPECT_EQ(under, app->read_pixels());
  } else {
    EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
    const auto colours = texels_of(
        other_field(), [&](int s) { return of_base(format.base, s / 255.0, std::round(s / 5.0) / 255); });
    emulation::Precision precision = emulation::ours;
    precision.value += format.step;
    const emulation::Image meant = shown_in_bytes(frame_of({colour_cube(colours, 30)}, backdrop), precision);
    expect_within(format.name, meant, under);
    EXPECT_GT(channels_outside(meant, std::vector<float>(under.size(), 0.2F)), 500) << "the test tests nothing";
  }
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

constexpr const char* deep_colours = "the texture's colours have more than 8 bits";
INSTANTIATE_TEST_SUITE_P(
    Of, Formats,
    ::testing::Values(
        Format{"ALPHA8", GL_ALPHA8, GL_ALPHA, nullptr, Base::alpha},
        Format{"ALPHA16", GL_ALPHA16, GL_ALPHA, nullptr, Base::alpha},
        Format{"ALPHA32F", GL_ALPHA32F_ARB, GL_ALPHA, nullptr, Base::alpha},
        Format{"ALPHA", GL_ALPHA, GL_ALPHA, nullptr, Base::alpha},
        Format{"LUMINANCE", GL_LUMINANCE, GL_LUMINANCE, nullptr, Base::luminance},
        Format{"LUMINANCE8", GL_LUMINANCE8, GL_LUMINANCE, nullptr, Base::luminance},
        Format{"LUMINANCE16", GL_LUMINANCE16, GL_LUMINANCE, nullptr, Base::luminance},
        Format{"LUMINANCE32F", GL_LUMINANCE32F_ARB, GL_LUMINANCE, nullptr, Base::luminance},
        Format{"INTENSITY", GL_INTENSITY, GL_LUMINANCE, nullptr, Base::intensity},
        Format{"INTENSITY8", GL_INTENSITY8, GL_LUMINANCE, nullptr, Base::intensity},
        Format{"INTENSITY16", GL_INTENSITY16, GL_LUMINANCE, nullptr, Base::intensity},
        Format{"INTENSITY16F", GL_INTENSITY16F_ARB, GL_LUMINANCE, nullptr, Base::intensity, half_step},
        Format{"R8", GL_R8, GL_RED, nullptr, Base::red}, Format{"R16", GL_R16, GL_RED, nullptr, Base::red},
        Format{"R16F", GL_R16F, GL_RED, nullptr, Base::red, half_step},
        Format{"R32F", GL_R32F, GL_RED, nullptr, Base::red}, Format{"RGBA8", GL_RGBA8, GL_RGBA, nullptr},
        Format{"RGBA", GL_RGBA, GL_RGBA, nullptr}, Format{"RGBA16", GL_RGBA16, GL_RGBA, deep_colours},
        Format{"RGBA32F", GL_RGBA32F, GL_RGBA, deep_colours},
        // Both channels of these two formats are s.
        Format{"RGB8", GL_RGB8, GL_RGB, nullptr, Base::luminance},
        Format{"LUMINANCE8_ALPHA8", GL_LUMINANCE8_ALPHA8, GL_LUMINANCE_ALPHA, nullptr, Base::intensity},
        Format{"LUMINANCE16_ALPHA16", GL_LUMINANCE16_ALPHA16, GL_LUMINANCE_ALPHA, deep_colours}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace understudy::spu::testing
