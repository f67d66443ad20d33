// SPDX-License-Identifier: Apache-2.0
// The client-side OpenGL state is derived from the calls.
#include "spu/remote/client_state.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "dispatch/call_words.h"

namespace understudy::spu {
namespace {

class ClientStateTest : public ::testing::Test {
 protected:
  void call(CallId call, std::initializer_list<std::uint64_t> words) {
    std::vector<std::uint64_t> all(words);
    all.resize(8);
    state.note(call, all.data());
  }
  std::optional<GLint> integer(GLenum name, Asker asker = Asker::application) {
    GLint value = -1;
    const std::uint64_t words[] = {name, word(&value)};
    std::uint64_t result = 0;
    if (!state.answer(CallId::GetIntegerv, words, asker, result)) return std::nullopt;
    return value;
  }
  std::optional<bool> enabled(GLenum name, Asker asker = Asker::application) {
    const std::uint64_t words[] = {name};
    std::uint64_t result = 0;
    if (!state.answer(CallId::IsEnabled, words, asker, result)) return std::nullopt;
    return result != 0;
  }

  ClientState state;
};

TEST_F(ClientStateTest, KnowsThePixelStore) {
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 4);
  call(CallId::PixelStorei, {GL_UNPACK_ALIGNMENT, 1});
  call(CallId::PixelStorei, {GL_UNPACK_ALIGNMENT, 3});  // an error
  call(CallId::PixelStoref, {GL_PACK_ROW_LENGTH, word(17.F)});
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 1);
  EXPECT_EQ(integer(GL_PACK_ROW_LENGTH), 17);
  call(CallId::PushClientAttrib, {GL_CLIENT_PIXEL_STORE_BIT});
  call(CallId::PixelStorei, {GL_UNPACK_ALIGNMENT, 8});
  call(CallId::PopClientAttrib, {});
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 1);
}

TEST_F(ClientStateTest, KnowsWhichBuffersAreBound) {
  call(CallId::BindBuffer, {GL_ARRAY_BUFFER, 3});
  call(CallId::BindBuffer, {GL_ELEMENT_ARRAY_BUFFER, 4});
  call(CallId::BindBufferBase, {GL_UNIFORM_BUFFER, 2, 9});
  EXPECT_EQ(integer(GL_ARRAY_BUFFER_BINDING), 3);
  EXPECT_EQ(integer(GL_ELEMENT_ARRAY_BUFFER_BINDING), 4);
  EXPECT_EQ(state.bound_buffer(GL_UNIFORM_BUFFER), 9U);
  call(CallId::BindVertexArray, {5});
  EXPECT_EQ(integer(GL_ELEMENT_ARRAY_BUFFER_BINDING), 0);
  EXPECT_EQ(integer(GL_ARRAY_BUFFER_BINDING), 3);
  call(CallId::BindVertexArray, {0});
  const GLuint gone[] = {3, 4};
  call(CallId::DeleteBuffers, {2, word(&gone[0])});
  EXPECT_EQ(integer(GL_ARRAY_BUFFER_BINDING), 0);
  EXPECT_EQ(integer(GL_ELEMENT_ARRAY_BUFFER_BINDING), 0);
}

TEST_F(ClientStateTest, KnowsArraysInTheApplicationsMemory) {
  const float vertices[9] = {};
  call(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  call(CallId::VertexPointer, {3, GL_FLOAT, 12, word(&vertices[0])});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), true);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_SIZE), 3);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_STRIDE), 12);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_BUFFER_BINDING), 0);
  void* pointer = nullptr;
  const std::uint64_t words[] = {GL_VERTEX_ARRAY_POINTER, word(&pointer)};
  std::uint64_t result = 0;
  ASSERT_TRUE(state.answer(CallId::GetPointerv, words, Asker::application, result));
  EXPECT_EQ(pointer, &vertices[0]);

  call(CallId::ClientActiveTexture, {GL_TEXTURE2});
  call(CallId::EnableClientState, {GL_TEXTURE_COORD_ARRAY});
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), true);
  call(CallId::ClientActiveTexture, {GL_TEXTURE0});
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), false);
}

TEST_F(ClientStateTest, LeavesOtherVertexArrayObjectsToOpenGL) {
  call(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  call(CallId::BindVertexArray, {1});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), std::nullopt);
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY, Asker::encoder), false);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_SIZE), std::nullopt);
  call(CallId::BindVertexArray, {0});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), true);
}

TEST_F(ClientStateTest, DoesNotGuess) {
  EXPECT_EQ(integer(GL_DEPTH_FUNC), std::nullopt);
  EXPECT_EQ(enabled(GL_BLEND), std::nullopt);
}

}  // namespace
}  // namespace understudy::spu
