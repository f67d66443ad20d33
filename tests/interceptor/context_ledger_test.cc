// SPDX-License-Identifier: Apache-2.0
#include "interceptor/context_ledger.h"

#include <gtest/gtest.h>

namespace {

using namespace understudy::interceptor;

constexpr std::uintptr_t display = 7;
ContextKey glx(std::uintptr_t handle) {
  return {WindowSystem::glx, display, handle};
}
ContextKey egl(std::uintptr_t handle) {
  return {WindowSystem::egl, display, handle};
}

TEST(ContextLedger, GivesEveryContextANumberOfItsOwnEvenWhenAHandleComesAgain) {
  note_created(glx(1), 0, true);
  const KnownContext first = note_current(glx(1), true);
  note_not_current(first.context);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), first.context);
  EXPECT_EQ(next_gone(), 0u);

  note_created(glx(1), 0, true);
  const KnownContext second = note_current(glx(1), true);
  EXPECT_NE(second.context, first.context);
  note_not_current(second.context);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), second.context);
}

TEST(ContextLedger, NamesAKnownContextOfTheGroupAsShare) {
  note_created(glx(1), 0, true);
  note_created(glx(2), 1, true);
  note_created(glx(3), 2, true);
  const KnownContext third = note_current(glx(3), true);
  EXPECT_EQ(third.share, 0u) << "nobody of the group is known yet";
  const KnownContext first = note_current(glx(1), true);
  EXPECT_EQ(first.share, third.context);
  for (const std::uintptr_t context : {first.context, third.context}) note_not_current(context);
  for (const std::uintptr_t handle : {1, 2, 3}) note_destroyed(glx(handle));
  EXPECT_NE(next_gone(), 0u);
  EXPECT_NE(next_gone(), 0u);
  EXPECT_EQ(next_gone(), 0u) << "the second was never known, so nobody is told";
}

TEST(ContextLedger, KeepsAGroupAliveUntilTheCoreHasMetAnotherMember) {
  note_created(glx(1), 0, true);
  note_created(glx(2), 1, true);
  const KnownContext first = note_current(glx(1), true);
  note_not_current(first.context);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), 0u);

  const KnownContext second = note_current(glx(2), true);
  EXPECT_EQ(second.share, first.context);
  EXPECT_EQ(next_gone(), first.context);
  note_not_current(second.context);
  note_destroyed(glx(2));
  EXPECT_EQ(next_gone(), second.context);
}

TEST(ContextLedger, TellsOfADestroyedContextOnlyWhenNoThreadHasItCurrent) {
  note_created(glx(1), 0, true);
  const KnownContext context = note_current(glx(1), true);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), 0u);
  note_not_current(context.context);
  EXPECT_EQ(next_gone(), context.context);
}

TEST(ContextLedger, TakesAHandleThatComesAgainWithoutDestructionForANewContext) {
  note_created(glx(1), 0, true);
  const KnownContext lost = note_current(glx(1), true);
  note_created(glx(1), 0, true);
  const KnownContext found = note_current(glx(1), true);
  EXPECT_NE(found.context, lost.context);
  EXPECT_EQ(next_gone(), lost.context);
  note_not_current(found.context);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), found.context);
}

TEST(ContextLedger, DoesNotConfuseTheWindowSystemsAndRemembersOpenGlEs) {
  note_created(glx(1), 0, true);
  note_created(egl(1), 0, false);
  const KnownContext desktop = note_current(glx(1), true);
  const KnownContext embedded = note_current(egl(1), true);
  EXPECT_NE(desktop.context, embedded.context);
  EXPECT_TRUE(desktop.desktop_gl);
  EXPECT_FALSE(embedded.desktop_gl);
  note_not_current(desktop.context);
  note_not_current(embedded.context);
  note_display_closed(WindowSystem::egl, display);
  EXPECT_EQ(next_gone(), embedded.context);
  EXPECT_EQ(next_gone(), 0u);
  note_destroyed(glx(1));
  EXPECT_EQ(next_gone(), desktop.context);
}

TEST(ContextLedger, LetsAnUnknownContextJoin) {
  const KnownContext context = note_current(egl(5), /*desktop_gl_if_new=*/false);
  EXPECT_NE(context.context, 0u);
  EXPECT_FALSE(context.desktop_gl);
  EXPECT_EQ(known_context(context.context).context, context.context);
  note_not_current(context.context);
  note_destroyed(egl(5));
  EXPECT_EQ(next_gone(), context.context);
  EXPECT_EQ(known_context(context.context).context, 0u);
}

}  // namespace
