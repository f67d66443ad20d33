// SPDX-License-Identifier: Apache-2.0
// Several contexts, names chosen by the application, and objects for which a driver returns different names.
#include <array>

#include "replayed.h"

namespace understudy::replay_test {
namespace {

using Contexts = Replayed;

/// A texture of one colour, with a name chosen by the application.
void make_texture(const spu::DispatchTable& gl, GLuint name, std::array<std::uint8_t, 4> colour) {
  gl.BindTexture(GL_TEXTURE_2D, name);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, colour.data());
}

void draw_with(const spu::DispatchTable& gl, GLuint texture, float left) {
  gl.BindTexture(GL_TEXTURE_2D, texture);
  gl.Enable(GL_TEXTURE_2D);
  gl.Rectf(left, -0.5F, left + 0.5F, 0.7F);
}

TEST_F(Contexts, ThatShareTextures) {
  make_texture(gl(), 4711, {250, 120, 10, 255});
  const GLuint list = gl().GenLists(1);
  gl().NewList(list, GL_COMPILE);
  gl().Rectf(0.1F, 0.75F, 0.9F, 0.95F);
  gl().EndList();
  application.add(compatibility_context(2, 1));
  draw_with(gl(), 4711, -0.8F);
  make_texture(gl(), 12, {10, 240, 90, 255});
  gl().CallList(list);
  application.show();
  application.make_current(1);
  draw_with(gl(), 12, 0.1F);
  expect_same_images();
}

TEST_F(Contexts, ThatShareNothingHaveTheSameNamesForOtherThings) {
  make_texture(gl(), 7, {250, 120, 10, 255});
  application.add(compatibility_context(2));
  make_texture(gl(), 7, {20, 40, 200, 255});
  draw_with(gl(), 7, 0);
  application.show();
  application.make_current(1);
  draw_with(gl(), 7, -0.7F);
  application.show();
  application.make_current(2);
  draw_with(gl(), 7, -0.9F);
  expect_same_images();
}

TEST_F(Contexts, OfWhichOneIsGoneWhenAnotherSharesWithIt) {
  make_texture(gl(), 3, {250, 120, 10, 255});
  application.add(compatibility_context(2, 1));
  draw_with(gl(), 3, -0.2F);
  expect_same_images();
}

TEST_F(Contexts, WithSyncObjects) {
  make_texture(gl(), 9, {90, 200, 120, 255});
  GLsync first = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  draw_with(gl(), 9, -0.4F);
  GLsync second = gl().FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl().WaitSync(first, 0, GL_TIMEOUT_IGNORED);
  EXPECT_NE(gl().ClientWaitSync(second, GL_SYNC_FLUSH_COMMANDS_BIT, 1'000'000'000), GLenum(GL_WAIT_FAILED));
  GLint state = 0;
  GLsizei length = 0;
  gl().GetSynciv(second, GL_SYNC_STATUS, 1, &length, &state);
  gl().DeleteSync(first);
  gl().DeleteSync(second);
  expect_same_images();
}

TEST_F(Contexts, WhoseNamesTheDriverGivesDifferently) {
  // Names are deleted and reused, so that the meaning of a name changes over the stream.
  std::array<GLuint, 4> names{};
  gl().GenTextures(4, names.data());
  gl().DeleteTextures(2, names.data());
  std::array<GLuint, 3> again{};
  gl().GenTextures(3, again.data());
  make_texture(gl(), again[0], {250, 20, 10, 255});
  make_texture(gl(), again[2], {20, 220, 10, 255});
  make_texture(gl(), names[3], {20, 20, 210, 255});
  draw_with(gl(), again[0], -0.9F);
  draw_with(gl(), again[2], -0.3F);
  draw_with(gl(), names[3], 0.3F);
  expect_same_images();
}

}  // namespace
}  // namespace understudy::replay_test
