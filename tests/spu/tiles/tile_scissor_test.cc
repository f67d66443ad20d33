// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/tile_scissor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "tests/spu/mock_driver.h"

namespace understudy::spu {
namespace {

TEST(RowsOfTile, AreAllRowsOnce) {
  for (const int height : {1, 2, 47, 480, 16384}) {
    for (const int parts : {2, 3, 16}) {
      int next = 0;
      for (int part = 0; part < parts; ++part) {
        const Rows rows = rows_of_tile(height, part, parts);
        EXPECT_EQ(rows.first, next);
        EXPECT_GE(rows.count, height / parts);
        EXPECT_LE(rows.count, height / parts + 1);
        next += rows.count;
      }
      EXPECT_EQ(next, height);
    }
  }
}

struct State {
  bool enabled = false;
  std::array<GLint, 4> box{0, 0, 100, 50};
  GLint framebuffer = 0;
  bool operator==(const State&) const = default;
};

/// Uses a mock driver with a scissor test.
class TileScissorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    state = {};
    DispatchTable& gl = driver_.slots();
    gl.Enable = [](GLenum) { state.enabled = true; };
    gl.Disable = [](GLenum) { state.enabled = false; };
    gl.IsEnabled = [](GLenum) -> GLboolean { return state.enabled; };
    gl.Scissor = [](GLint x, GLint y, GLsizei width, GLsizei height) { state.box = {x, y, width, height}; };
    gl.GetIntegerv = [](GLenum name, GLint* values) {
      if (name == GL_SCISSOR_BOX) std::copy(state.box.begin(), state.box.end(), values);
      if (name == GL_DRAW_FRAMEBUFFER_BINDING) *values = state.framebuffer;
    };
    scissor_.set(100, {20, 10});
  }
  void note(CallId call, std::array<std::uint64_t, 4> words = {}) { scissor_.note(call, words.data()); }

  static inline State state;
  testing::MockDriver driver_;
  const DispatchTable& gl_ = driver_.table();
  std::atomic<bool> lists_ = false;
  TileScissor scissor_{lists_};
};

TEST_F(TileScissorTest, IsThereDuringADrawAlone) {
  const State before = state;
  ASSERT_TRUE(scissor_.begin(gl_, false));
  EXPECT_TRUE(state.enabled);
  EXPECT_EQ(state.box, (std::array<GLint, 4>{0, 20, 100, 10}));
  scissor_.end(gl_);
  EXPECT_EQ(state, before);
}

TEST_F(TileScissorTest, LeavesOfTheApplicationsBoxWhatIsInTheTile) {
  state.enabled = true;
  for (const auto& [box, within] : std::vector<std::pair<std::array<GLint, 4>, std::array<GLint, 4>>>{
           {{5, 0, 7, 25}, {5, 20, 7, 5}}, {{5, 22, 7, 3}, {5, 22, 7, 3}}, {{5, 40, 7, 3}, {5, 40, 7, 0}}}) {
    state.box = box;
    note(CallId::Scissor);
    ASSERT_TRUE(scissor_.begin(gl_, false));
    EXPECT_EQ(state.box, within);
    scissor_.end(gl_);
    EXPECT_TRUE(state.enabled);
    EXPECT_EQ(state.box, box);
  }
}

TEST_F(TileScissorTest, IsNotForFramebufferObjects) {
  ASSERT_TRUE(scissor_.begin(gl_, false));
  scissor_.end(gl_);
  state.framebuffer = 3;
  note(CallId::BindFramebuffer, {GL_FRAMEBUFFER, 3});
  EXPECT_FALSE(scissor_.begin(gl_, false));
}

TEST_F(TileScissorTest, IsNotCompiled) {
  note(CallId::NewList, {1, GL_COMPILE});
  EXPECT_FALSE(scissor_.begin(gl_, false));
  note(CallId::EndList);
  EXPECT_TRUE(scissor_.begin(gl_, true)) << "a list that leaves the scissor test alone";
}

TEST_F(TileScissorTest, IsNotAroundListsThatChangeIt) {
  for (const auto& [call, word] : std::vector<std::pair<CallId, std::uint64_t>>{
           {CallId::Scissor, 0}, {CallId::Enable, GL_SCISSOR_TEST}, {CallId::PopAttrib, 0}}) {
    lists_ = false;
    note(CallId::NewList, {1, GL_COMPILE});
    note(call, {word});
    note(CallId::EndList);
    EXPECT_FALSE(scissor_.begin(gl_, true));
    EXPECT_TRUE(scissor_.begin(gl_, false));
    scissor_.end(gl_);
  }
  lists_ = false;
  note(CallId::NewList, {1, GL_COMPILE});
  note(CallId::PushAttrib);
  note(CallId::EndList);
  EXPECT_FALSE(scissor_.begin(gl_, true)) << "the tile's scissor test would be pushed";
  lists_ = false;
  note(CallId::NewList, {1, GL_COMPILE});
  note(CallId::PushAttrib);
  note(CallId::Enable, {GL_BLEND});
  note(CallId::PopAttrib);
  note(CallId::EndList);
  EXPECT_TRUE(scissor_.begin(gl_, true));
}

TEST_F(TileScissorTest, IsNotWhereViewportsHaveBoxesOfTheirOwn) {
  note(CallId::ScissorIndexed, {1, 0, 0, 5});
  EXPECT_FALSE(scissor_.begin(gl_, false));
}

}  // namespace
}  // namespace understudy::spu
