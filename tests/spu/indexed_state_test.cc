// SPDX-License-Identifier: Apache-2.0
// The state of single draw buffers outlasts our own drawing, also if a list of another context set it.
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "slice_scenes.h"

namespace understudy::spu::testing {
namespace {

TEST(IndexedState, SetByAListOfAnotherContextStays) {
  auto app = GlApplication::start(Profile::compatibility);
  if (!app) GTEST_SKIP() << "no EGL context here";
  const SliceScene scene = client_arrays_table();
  scene.set_up(*app);
  const GLuint list = app->gl().GenLists(1);
  std::thread([&] {
    const auto other = app->start_companion();
    ASSERT_TRUE(other);
    other->gl().NewList(list, GL_COMPILE);
    other->gl().ColorMaski(1, GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
    other->gl().EndList();
    other->gl().Finish();
  }).join();
  app->gl().CallList(list);
  scene.draw(*app, 10);
  app->end_frame();
  EXPECT_EQ(app->substituted(), 1U) << app->last_reason();
  std::array<GLboolean, 4> mask{};
  app->driver().GetBooleani_v(GL_COLOR_WRITEMASK, 1, mask.data());
  EXPECT_EQ(mask, (std::array<GLboolean, 4>{GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE}));
  EXPECT_EQ(app->error(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace understudy::spu::testing
