// SPDX-License-Identifier: Apache-2.0
// Calls as readable text.
#include "spu/print/call_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

template <class... Arguments>
std::string text_of(CallId call, Arguments... arguments) {
  const std::array<std::uint64_t, sizeof...(Arguments) + 1> words{word(arguments)...};
  fmt::memory_buffer text;
  append_call(text, call, words.data(), 0);
  return fmt::to_string(text);
}

std::string text_with_result(CallId call, const std::uint64_t* words, std::uint64_t result) {
  fmt::memory_buffer text;
  append_call(text, call, words, result);
  return fmt::to_string(text);
}

TEST(CallText, NamesArgumentsAndTheirValues) {
  EXPECT_EQ(text_of(CallId::Finish), "glFinish()");
  EXPECT_EQ(text_of(CallId::Vertex3f, 1.0F, -2.5F, 0.1F), "glVertex3f(x = 1, y = -2.5, z = 0.1)");
  EXPECT_EQ(text_of(CallId::DepthRange, 0.0, 0.25), "glDepthRange(n = 0, f = 0.25)");
  EXPECT_EQ(text_of(CallId::BindTexture, GLenum(GL_TEXTURE_2D), 7U),
            "glBindTexture(target = GL_TEXTURE_2D, texture = 7)");
  EXPECT_EQ(text_of(CallId::Clear, GLbitfield(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)),
            "glClear(mask = GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT)");
  EXPECT_EQ(text_of(CallId::DepthMask, GLboolean(GL_TRUE)), "glDepthMask(flag = GL_TRUE)");
  EXPECT_EQ(text_of(CallId::Uniform1i, -1, -7), "glUniform1i(location = -1, v0 = -7)");
}

TEST(CallText, ShowsWhatPointersStandFor) {
  const GLfloat colour[4] = {1, 0.5F, 0, 1};
  EXPECT_EQ(text_of(CallId::Color4fv, &colour[0]), "glColor4fv(v = {1, 0.5, 0, 1})");
  const std::array<std::byte, 4096> pixels{};
  EXPECT_EQ(
      text_of(CallId::TexImage2D, GLenum(GL_TEXTURE_2D), 0, GLint(GL_RGBA8), 32, 32, 0, GLenum(GL_RGBA),
              GLenum(GL_UNSIGNED_BYTE), static_cast<const void*>(pixels.data())),
      "glTexImage2D(target = GL_TEXTURE_2D, level = 0, internalformat = GL_RGBA8, width = 32, height = 32, "
      "border = 0, format = GL_RGBA, type = GL_UNSIGNED_BYTE, pixels = 4096 bytes)");
  EXPECT_THAT(text_of(CallId::TexImage2D, GLenum(GL_TEXTURE_2D), 0, GLint(GL_RGBA8), 32, 32, 0, GLenum(GL_RGBA),
                      GLenum(GL_UNSIGNED_BYTE), static_cast<const void*>(nullptr)),
              EndsWith("pixels = NULL)"));
  EXPECT_EQ(text_of(CallId::GetUniformLocation, 3U, "matrix"),
            "glGetUniformLocation(program = 3, name = \"matrix\") = 0");
  const std::array<GLfloat, 32> matrices{};
  EXPECT_THAT(text_of(CallId::UniformMatrix4fv, 0, 2, GLboolean(GL_FALSE), matrices.data()),
              EndsWith("value = 128 bytes)"));
}

// These pointers are offsets into a buffer object and are not dereferenced.
TEST(CallText, FollowsNoOffset) {
  const auto* offset = argument<const void*>(24);
  EXPECT_EQ(
      text_of(CallId::DrawElements, GLenum(GL_TRIANGLES), 6, GLenum(GL_UNSIGNED_SHORT), offset),
      "glDrawElements(mode = GL_TRIANGLES, count = 6, type = GL_UNSIGNED_SHORT, indices = 12 bytes at 24)");
  EXPECT_THAT(text_of(CallId::VertexPointer, 3, GLenum(GL_FLOAT), 0, offset), EndsWith("pointer = 0x18)"));
  EXPECT_THAT(text_of(CallId::PixelMapfv, GLenum(GL_PIXEL_MAP_I_TO_R), 2, offset), EndsWith("bytes at 24)"));
}

TEST(CallText, KeepsTextsShortAndOnOneLine) {
  const std::string name = "a\n\"\x01" + std::string(500, 'b');
  const std::string text = text_of(CallId::GetUniformLocation, 3U, name.c_str());
  EXPECT_THAT(text, HasSubstr("name = \"a\\n\\\"?bbb"));
  EXPECT_THAT(text, EndsWith("b\"...) = 0"));
  EXPECT_LT(text.size(), 200U);
}

TEST(CallText, ShowsOutcomes) {
  EXPECT_FALSE(shows_outcome(CallId::Clear));
  EXPECT_FALSE(shows_outcome(CallId::Color4fv));
  EXPECT_TRUE(shows_outcome(CallId::GetError));
  EXPECT_TRUE(shows_outcome(CallId::GenTextures));
  EXPECT_EQ(text_with_result(CallId::GetError, nullptr, 0), "glGetError() = GL_NO_ERROR");
  EXPECT_EQ(text_with_result(CallId::GetError, nullptr, GL_INVALID_ENUM), "glGetError() = GL_INVALID_ENUM");
  const GLuint names[2] = {7, 9};
  const std::array<std::uint64_t, 2> gen{2, word(&names[0])};
  EXPECT_EQ(text_with_result(CallId::GenTextures, gen.data(), 0), "glGenTextures(n = 2, textures = {7, 9})");
  const std::array<std::uint64_t, 1> get{GL_VERSION};
  EXPECT_EQ(text_with_result(CallId::GetString, get.data(), word("4.5 of somebody")),
            "glGetString(name = GL_VERSION) = \"4.5 of somebody\"");
}

// For any values, no null pointer is dereferenced, and every command has a text.
TEST(CallText, EveryCommandHasOne) {
  const std::array<std::uint64_t, max_parameters> zeros{};
  std::array<std::uint64_t, max_parameters> numbers{};
  for (std::size_t i = 0; i < call_count; ++i) {
    fmt::memory_buffer text;
    append_call(text, CallId(i), zeros.data(), 0);
    EXPECT_THAT(fmt::to_string(text), HasSubstr(std::string(call_name(CallId(i))) + "("));
    // Values of all kinds, with null pointers.
    for (const std::uint64_t value : {std::uint64_t{3}, ~std::uint64_t{0}, std::uint64_t{0x84c0}}) {
      const auto parameters = call_shape(CallId(i)).parameters();
      for (std::size_t p = 0; p < parameters.size(); ++p) numbers[p] = parameters[p].pointer > 0 ? 0 : value;
      text.clear();
      append_call(text, CallId(i), numbers.data(), 0);
      EXPECT_THAT(fmt::to_string(text), HasSubstr("("));
    }
  }
}

}  // namespace
}  // namespace understudy::spu
