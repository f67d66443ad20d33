// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/front_buffer.h"

#include <gtest/gtest.h>

#include <array>

namespace understudy::spu {
namespace {

class FrontBufferTest : public ::testing::Test {
 protected:
  template <class... Words>
  void call(CallId call, Words... words) {
    const std::array<std::uint64_t, sizeof...(words) + 1> all = {std::uint64_t(words)..., 0};
    left_ = front_.is_left_by(call, all.data());
    front_.note(call, all.data());
  }
  void clear() { call(CallId::Clear, GL_COLOR_BUFFER_BIT); }
  /// Whether the front buffer was drawn to since the last query.
  bool is_drawn() {
    const bool drawn = front_.is_drawn();
    front_.shown();
    return drawn;
  }
  bool draws() {
    clear();
    return is_drawn();
  }

  ShareGroup group_;
  FrontBuffer front_{true, group_};
  bool left_ = false;  ///< whether the last call leaves the front buffer
};

TEST_F(FrontBufferTest, IsDrawnIntoWhileItIsChosen) {
  EXPECT_FALSE(draws());
  call(CallId::DrawBuffer, GL_FRONT);
  EXPECT_FALSE(is_drawn()) << "nothing is drawn yet";
  EXPECT_TRUE(draws());
  call(CallId::Viewport, 0, 0, 10, 10);
  call(CallId::Flush);
  EXPECT_FALSE(is_drawn());
  call(CallId::Begin, GL_TRIANGLES);
  EXPECT_TRUE(is_drawn());
  call(CallId::DrawBuffer, GL_BACK);
  EXPECT_TRUE(left_);
  EXPECT_FALSE(draws());
  for (const GLenum name : {GL_FRONT_LEFT, GL_FRONT_AND_BACK, GL_LEFT}) {
    call(CallId::DrawBuffer, name);
    EXPECT_FALSE(left_);
    EXPECT_TRUE(draws()) << name;
  }
  const std::array<GLenum, 2> several = {GL_BACK_LEFT, GL_FRONT_LEFT};
  call(CallId::DrawBuffers, 1, reinterpret_cast<std::uintptr_t>(several.data()));
  EXPECT_FALSE(draws());
  call(CallId::DrawBuffers, 2, reinterpret_cast<std::uintptr_t>(several.data()));
  EXPECT_TRUE(draws());
}

TEST_F(FrontBufferTest, IsTheOnlyOneOfAWindowWithOneBuffer) {
  front_ = FrontBuffer(false, group_);
  EXPECT_TRUE(draws());
  call(CallId::DrawBuffer, GL_BACK);
  EXPECT_TRUE(draws());
  call(CallId::DrawBuffer, GL_NONE);
  EXPECT_FALSE(draws());
}

TEST_F(FrontBufferTest, FramebufferObjectsHaveNone) {
  call(CallId::DrawBuffer, GL_FRONT);
  call(CallId::BindFramebuffer, GL_READ_FRAMEBUFFER, 3);
  EXPECT_TRUE(draws());
  call(CallId::BindFramebuffer, GL_FRAMEBUFFER, 3);
  EXPECT_FALSE(draws());
  call(CallId::DrawBuffer, GL_COLOR_ATTACHMENT0);
  call(CallId::NamedFramebufferDrawBuffer, 3, GL_COLOR_ATTACHMENT0);
  call(CallId::ClearNamedFramebufferfv, 3);
  EXPECT_FALSE(is_drawn());
  call(CallId::ClearNamedFramebufferfv, 0);
  EXPECT_TRUE(is_drawn());
  call(CallId::BlitNamedFramebuffer, 3, 0);
  EXPECT_TRUE(is_drawn());
  const GLuint name = 3;
  call(CallId::DeleteFramebuffers, 1, reinterpret_cast<std::uintptr_t>(&name));
  EXPECT_TRUE(draws());
  call(CallId::NamedFramebufferDrawBuffer, 0, GL_BACK);
  EXPECT_TRUE(left_);
  EXPECT_FALSE(draws());
}

TEST_F(FrontBufferTest, AttributesBringItBack) {
  call(CallId::PushAttrib, GL_COLOR_BUFFER_BIT);
  call(CallId::DrawBuffer, GL_FRONT);
  call(CallId::PushAttrib, GL_ENABLE_BIT);
  call(CallId::PopAttrib);
  EXPECT_TRUE(draws());
  call(CallId::PopAttrib);
  EXPECT_TRUE(left_);
  EXPECT_FALSE(draws());
  call(CallId::PopAttrib);
  EXPECT_FALSE(draws());
}

TEST_F(FrontBufferTest, ListsDoWhatTheyHold) {
  call(CallId::NewList, 1, GL_COMPILE);
  call(CallId::DrawBuffer, GL_FRONT);
  clear();
  call(CallId::DrawBuffer, GL_BACK);
  call(CallId::EndList);
  call(CallId::NewList, 2, GL_COMPILE);
  call(CallId::PushAttrib, GL_COLOR_BUFFER_BIT);
  call(CallId::DrawBuffer, GL_FRONT);
  call(CallId::PopAttrib);
  clear();
  call(CallId::EndList);
  call(CallId::NewList, 3, GL_COMPILE);
  call(CallId::DrawBuffer, GL_FRONT);
  call(CallId::EndList);
  call(CallId::NewList, 4, GL_COMPILE);
  call(CallId::CallList, 3);
  call(CallId::EndList);
  EXPECT_FALSE(draws()) << "none was called yet";
  call(CallId::CallList, 1);
  EXPECT_TRUE(is_drawn());
  EXPECT_FALSE(draws());
  call(CallId::CallList, 2);
  EXPECT_FALSE(is_drawn());
  call(CallId::CallList, 4);
  EXPECT_FALSE(is_drawn());
  EXPECT_TRUE(draws());
  call(CallId::CallList, 2);
  EXPECT_TRUE(is_drawn());
  FrontBuffer shares(true, group_);
  const std::array<std::uint64_t, 1> list = {3};
  shares.note(CallId::CallList, list.data());
  shares.note(CallId::Begin, list.data());
  EXPECT_TRUE(shares.is_drawn());
  call(CallId::DeleteLists, 1, 4);
  call(CallId::DrawBuffer, GL_BACK);
  call(CallId::CallList, 3);
  EXPECT_FALSE(draws());
  call(CallId::NewList, 5, GL_COMPILE_AND_EXECUTE);
  call(CallId::DrawBuffer, GL_FRONT);
  call(CallId::EndList);
  EXPECT_TRUE(draws());
}

}  // namespace
}  // namespace understudy::spu
