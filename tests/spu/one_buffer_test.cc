// SPDX-License-Identifier: Apache-2.0
// Some drivers accept the name of a missing back buffer for the front buffer, others refuse it, so the player
// translates the name. The effect on a driver is tested in tests/replay/osmesa_contexts_test.cc.
#include "spu/player/one_buffer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

using ::testing::ElementsAre;

std::vector<GLenum> listed_below;

class OneBufferTest : public ::testing::Test {
 protected:
  OneBufferTest() {
    driver.slots().DrawBuffers = [](GLsizei count, const GLenum* buffers) {
      listed_below.assign(buffers, buffers + count);
    };
  }
  std::uint64_t last(std::size_t word) const { return driver.calls().back().words.at(word); }
  template <std::size_t count>
  std::vector<GLenum> below(const DispatchTable& gl, const std::array<GLenum, count>& buffers) const {
    gl.DrawBuffers(count, buffers.data());
    return listed_below;
  }

  testing::MockDriver driver;
};

TEST_F(OneBufferTest, NamesOfTheBackBufferBecomeThoseOfTheFrontBuffer) {
  OneBuffer one(driver.table());
  const DispatchTable& gl = one.table();
  one.made_current(true);
  gl.DrawBuffer(GL_BACK);
  EXPECT_EQ(last(0), GL_FRONT);
  gl.DrawBuffer(GL_BACK_LEFT);
  EXPECT_EQ(last(0), GL_FRONT_LEFT);
  gl.ReadBuffer(GL_BACK);
  EXPECT_EQ(last(0), GL_FRONT);
  gl.NamedFramebufferDrawBuffer(0, GL_BACK);
  EXPECT_EQ(last(1), GL_FRONT);
  gl.NamedFramebufferReadBuffer(0, GL_BACK_LEFT);
  EXPECT_EQ(last(1), GL_FRONT_LEFT);
  GLint ignored = 0;
  gl.GetFramebufferAttachmentParameteriv(GL_FRAMEBUFFER, GL_BACK_LEFT, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE,
                                         &ignored);
  EXPECT_EQ(last(1), GL_FRONT_LEFT);
  EXPECT_THAT(below<1>(gl, {GL_BACK}), ElementsAre(GL_FRONT_LEFT)) << "GL_FRONT is not allowed there";
  EXPECT_THAT(below<2>(gl, {GL_NONE, GL_BACK_LEFT}), ElementsAre(GL_NONE, GL_FRONT_LEFT));
  EXPECT_THAT(below<2>(gl, {GL_BACK, GL_NONE}), ElementsAre(GL_BACK, GL_NONE)) << "an error stays one";
  // A right buffer never existed.
  gl.DrawBuffer(GL_BACK_RIGHT);
  EXPECT_EQ(last(0), GL_BACK_RIGHT);
  gl.DrawBuffer(GL_COLOR_ATTACHMENT0);
  EXPECT_EQ(last(0), GL_COLOR_ATTACHMENT0);
}

TEST_F(OneBufferTest, SinglyBufferedContextsSpeakForThemselves) {
  OneBuffer one(driver.table());
  one.made_current(false);
  one.table().DrawBuffer(GL_BACK);
  EXPECT_EQ(last(0), GL_BACK);
  EXPECT_THAT(below<1>(one.table(), {GL_BACK}), ElementsAre(GL_BACK));
}

TEST_F(OneBufferTest, WhatTheDriverLacksStaysLackingAndTheRestIsItsOwn) {
  driver.lacks(CallId::NamedFramebufferDrawBuffer);
  const OneBuffer one(driver.table());
  EXPECT_EQ(one.table().NamedFramebufferDrawBuffer, nullptr);
  EXPECT_EQ(one.table().Vertex3f, driver.table().Vertex3f);
}

}  // namespace
}  // namespace understudy::spu
