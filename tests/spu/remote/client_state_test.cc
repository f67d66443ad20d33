// SPDX-License-Identifier: Apache-2.0
// The client-side OpenGL state is derived from the calls.
#include "spu/remote/client_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>

#include "dispatch/call_shape.h"
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
  const void* pointer(GLenum name) {
    const void* value = nullptr;
    const std::uint64_t words[] = {name, word(&value)};
    std::uint64_t result = 0;
    return state.answer(CallId::GetPointerv, words, Asker::application, result) ? value : nullptr;
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

/// Whether any array of the state points to `memory`.
bool points_to(const ClientState& state, const void* memory) {
  constexpr std::array names = {
      GL_VERTEX_ARRAY_POINTER,          GL_NORMAL_ARRAY_POINTER,        GL_COLOR_ARRAY_POINTER,
      GL_SECONDARY_COLOR_ARRAY_POINTER, GL_FOG_COORD_ARRAY_POINTER,     GL_INDEX_ARRAY_POINTER,
      GL_EDGE_FLAG_ARRAY_POINTER,       GL_TEXTURE_COORD_ARRAY_POINTER, GL_VERTEX_ATTRIB_ARRAY_POINTER};
  return std::any_of(names.begin(), names.end(), [&](GLenum name) {
    const void* value = nullptr;
    std::uint64_t result = 0;
    const bool generic = name == GL_VERTEX_ATTRIB_ARRAY_POINTER;
    const std::uint64_t words[] = {generic ? 0 : name, generic ? name : word(&value), word(&value)};
    state.answer(generic ? CallId::GetVertexAttribPointerv : CallId::GetPointerv, words, Asker::application,
                 result);
    return value == memory;
  });
}

std::uint64_t argument_for(std::string_view parameter, const void* memory) {
  if (parameter == "size") return 3;
  if (parameter == "type") return GL_FLOAT;
  if (parameter == "texunit") return GL_TEXTURE0;
  if (parameter == "format") return GL_V3F;
  return parameter == "pointer" ? word(memory) : 0;
}

TEST_F(ClientStateTest, KnowsEveryCommandThatPointsAnArray) {
  // Of extensions whose arrays the encoder does not send; Mesa supports none of them.
  constexpr std::array unsupported = {
      CallId::BinormalPointerEXT,        CallId::ElementPointerAPPLE,    CallId::ElementPointerATI,
      CallId::MatrixIndexPointerARB,     CallId::MatrixIndexPointerOES,  CallId::PointSizePointerOES,
      CallId::ReplacementCodePointerSUN, CallId::TangentPointerEXT,      CallId::VariantPointerEXT,
      CallId::VertexAttribPointerNV,     CallId::VertexWeightPointerEXT, CallId::WeightPointerARB,
      CallId::WeightPointerOES};
  const std::array<std::byte, 8> memory{};
  int known = 0;
  for (std::size_t i = 0; i < call_count; ++i) {
    const auto parameters = call_shape(CallId(i)).parameters();
    const bool points = std::any_of(parameters.begin(), parameters.end(), [](const ParameterShape& parameter) {
      return parameter.rule == ExtentRule::client_array;
    });
    if (!points || std::find(unsupported.begin(), unsupported.end(), CallId(i)) != unsupported.end()) continue;
    std::vector<std::uint64_t> words;
    for (const ParameterShape& parameter : parameters) words.push_back(argument_for(parameter.name(), &memory));
    ClientState anew;
    anew.note(CallId(i), words.data());
    EXPECT_TRUE(points_to(anew, &memory)) << call_name(CallId(i));
    ++known;
  }
  EXPECT_GE(known, 20);
}

TEST_F(ClientStateTest, KnowsInterleavedArrays) {
  const std::array<std::byte, 200> memory{};
  call(CallId::EnableClientState, {GL_EDGE_FLAG_ARRAY});
  call(CallId::InterleavedArrays, {GL_T2F_C4F_N3F_V3F, 0, word(&memory)});
  EXPECT_EQ(enabled(GL_EDGE_FLAG_ARRAY), false);
  for (const GLenum array : {GL_TEXTURE_COORD_ARRAY, GL_COLOR_ARRAY, GL_NORMAL_ARRAY, GL_VERTEX_ARRAY})
    EXPECT_EQ(enabled(array), true);
  EXPECT_EQ(pointer(GL_TEXTURE_COORD_ARRAY_POINTER), &memory[0]);
  EXPECT_EQ(pointer(GL_COLOR_ARRAY_POINTER), &memory[8]);
  EXPECT_EQ(pointer(GL_NORMAL_ARRAY_POINTER), &memory[24]);
  EXPECT_EQ(pointer(GL_VERTEX_ARRAY_POINTER), &memory[36]);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_STRIDE), 48);
  call(CallId::InterleavedArrays, {GL_C4UB_V2F, 20, word(&memory)});
  EXPECT_EQ(enabled(GL_NORMAL_ARRAY), false);
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), false);
  EXPECT_EQ(integer(GL_COLOR_ARRAY_TYPE), GL_UNSIGNED_BYTE);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_SIZE), 2);
  EXPECT_EQ(integer(GL_VERTEX_ARRAY_STRIDE), 20);
  EXPECT_EQ(pointer(GL_VERTEX_ARRAY_POINTER), &memory[4]);
}

TEST_F(ClientStateTest, KnowsArraysOfATextureUnitThatIsNotActive) {
  const float coordinates[8] = {};
  call(CallId::MultiTexCoordPointerEXT, {GL_TEXTURE3, 2, GL_FLOAT, 8, word(&coordinates[0])});
  call(CallId::EnableClientStateiEXT, {GL_TEXTURE_COORD_ARRAY, 3});
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), false);
  call(CallId::ClientActiveTexture, {GL_TEXTURE3});
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), true);
  EXPECT_EQ(pointer(GL_TEXTURE_COORD_ARRAY_POINTER), &coordinates[0]);
  call(CallId::ClientActiveTexture, {GL_TEXTURE0});
  call(CallId::DisableClientStateIndexedEXT, {GL_TEXTURE_COORD_ARRAY, 3});
  call(CallId::ClientActiveTexture, {GL_TEXTURE3});
  EXPECT_EQ(enabled(GL_TEXTURE_COORD_ARRAY), false);
}

TEST_F(ClientStateTest, KnowsDefaultsThatArePushed) {
  const float vertices[9] = {};
  call(CallId::PixelStorei, {GL_UNPACK_ALIGNMENT, 1});
  call(CallId::BindBuffer, {GL_PIXEL_UNPACK_BUFFER, 7});
  call(CallId::BindBuffer, {GL_ARRAY_BUFFER, 8});
  call(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  call(CallId::PushClientAttribDefaultEXT, {GL_CLIENT_PIXEL_STORE_BIT});
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 4);
  EXPECT_EQ(integer(GL_PIXEL_UNPACK_BUFFER_BINDING), 0);
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), true) << "not in the mask";
  call(CallId::PopClientAttrib, {});
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 1);
  EXPECT_EQ(integer(GL_PIXEL_UNPACK_BUFFER_BINDING), 7);

  call(CallId::PushClientAttribDefaultEXT, {GL_CLIENT_VERTEX_ARRAY_BIT});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), false);
  EXPECT_EQ(integer(GL_ARRAY_BUFFER_BINDING), 0);
  call(CallId::VertexPointer, {3, GL_FLOAT, 12, word(&vertices[0])});
  call(CallId::PopClientAttrib, {});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), true);
  EXPECT_EQ(integer(GL_ARRAY_BUFFER_BINDING), 8);
  EXPECT_EQ(pointer(GL_VERTEX_ARRAY_POINTER), nullptr);
  call(CallId::ClientAttribDefaultEXT, {GLbitfield(GL_CLIENT_ALL_ATTRIB_BITS)});
  EXPECT_EQ(enabled(GL_VERTEX_ARRAY), false);
  EXPECT_EQ(integer(GL_UNPACK_ALIGNMENT), 4);
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
