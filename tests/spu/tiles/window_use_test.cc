// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/window_use.h"

#include <gtest/gtest.h>

#include <array>

#include "dispatch/table.h"

namespace understudy::spu {
namespace {

std::uint64_t word(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

TEST(WindowUse, IsKnownByName) {
  EXPECT_EQ(window_use(CallId::DrawElementsInstanced), WindowUse::draws);
  EXPECT_EQ(window_use(CallId::Clear), WindowUse::draws);
  EXPECT_EQ(window_use(CallId::ClearBufferfv), WindowUse::draws);
  EXPECT_EQ(window_use(CallId::Bitmap), WindowUse::draws);
  EXPECT_EQ(window_use(CallId::DrawPixels), WindowUse::draws);
  EXPECT_EQ(window_use(CallId::DrawBuffer), WindowUse::none);
  EXPECT_EQ(window_use(CallId::ClearColor), WindowUse::none);
  EXPECT_EQ(window_use(CallId::ClearBufferData), WindowUse::none);
  EXPECT_EQ(window_use(CallId::DispatchCompute), WindowUse::none);
  EXPECT_EQ(window_use(CallId::CopyTexSubImage2D), WindowUse::copies);
  EXPECT_EQ(window_use(CallId::CopyTextureSubImage2D), WindowUse::copies);
  EXPECT_EQ(window_use(CallId::CopyPixels), WindowUse::copies);
  EXPECT_EQ(window_use(CallId::CopyBufferSubData), WindowUse::none);
  EXPECT_EQ(window_use(CallId::BlitNamedFramebuffer), WindowUse::blits);
  EXPECT_EQ(window_use(CallId::ReadnPixels), WindowUse::reads);
  EXPECT_EQ(window_use(CallId::GetTexImage), WindowUse::asks);
  EXPECT_EQ(window_use(CallId::GetIntegerv), WindowUse::asks);
  EXPECT_EQ(window_use(CallId::ClearNamedFramebufferfv), WindowUse::none) << "it names another framebuffer";
  // Later calls use the location that it returns.
  EXPECT_EQ(window_use(CallId::GetUniformLocation), WindowUse::none);
}

TEST(WindowUse, WhatTilesCannotMakeIsNamed) {
  const auto why = [](CallId call, std::array<std::uint64_t, 4> words) {
    return beyond_tiles(call, words.data()) != nullptr;
  };
  EXPECT_TRUE(why(CallId::Accum, {GL_ACCUM}));
  EXPECT_TRUE(why(CallId::BeginQuery, {GL_SAMPLES_PASSED, 1}));
  EXPECT_TRUE(why(CallId::BeginQueryIndexed, {GL_ANY_SAMPLES_PASSED, 0, 1}));
  EXPECT_FALSE(why(CallId::BeginQuery, {GL_PRIMITIVES_GENERATED, 1}));
  EXPECT_TRUE(why(CallId::BindBufferBase, {GL_SHADER_STORAGE_BUFFER, 0, 1}));
  EXPECT_FALSE(why(CallId::BindBufferBase, {GL_UNIFORM_BUFFER, 0, 1}));
  EXPECT_FALSE(why(CallId::BindBuffer, {GL_ARRAY_BUFFER, 1}));
  EXPECT_TRUE(why(CallId::GetTextureHandleARB, {1}));
  EXPECT_TRUE(why(CallId::DrawBuffer, {GL_FRONT_AND_BACK}));
  EXPECT_FALSE(why(CallId::DrawBuffer, {GL_BACK}));
  EXPECT_TRUE(why(CallId::NamedFramebufferDrawBuffer, {0, GL_FRONT}));
  const std::array<GLenum, 2> buffers = {GL_BACK_LEFT, GL_FRONT_LEFT};
  EXPECT_TRUE(why(CallId::DrawBuffers, {2, word(buffers.data())}));
  EXPECT_FALSE(why(CallId::DrawBuffers, {1, word(buffers.data())}));
  EXPECT_TRUE(why(CallId::NamedFramebufferDrawBuffers, {0, 2, word(buffers.data())}));
}

}  // namespace
}  // namespace understudy::spu
