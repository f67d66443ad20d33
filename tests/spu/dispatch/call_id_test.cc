// SPDX-License-Identifier: Apache-2.0
#include "dispatch/call_id.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace understudy::spu;

TEST(CallId, EveryNumberHasANameAndEveryNameItsNumber) {
  std::string previous;
  for (std::size_t number = 0; number < call_count; ++number) {
    const auto call = static_cast<CallId>(number);
    const std::string name = call_name(call);
    EXPECT_EQ(name.substr(0, 2), "gl");
    EXPECT_LT(previous, name);
    ASSERT_TRUE(find_call(name).has_value()) << name;
    EXPECT_EQ(*find_call(name), call) << name;
    previous = name;
  }
  EXPECT_EQ(call_name(CallId::Clear), std::string("glClear"));
  EXPECT_EQ(find_call("glVertex3f"), CallId::Vertex3f);
}

TEST(CallId, WhatIsNoCommandHasNoNumber) {
  for (const char* name : {"", "gl", "Clear", "glClea", "glClearX", "glXSwapBuffers", "zzz"}) {
    EXPECT_FALSE(find_call(name).has_value()) << name;
  }
  EXPECT_EQ(call_name(static_cast<CallId>(call_count)), std::string("?"));
}

TEST(CallId, ASlotIsTheMemberOfThatName) {
  static int cleared = 0;
  const auto clear = [](GLbitfield) { ++cleared; };
  DispatchTable table{};
  EXPECT_EQ(slot(table, CallId::Clear), nullptr);
  set_slot(table, CallId::Clear, reinterpret_cast<AnyFunction>(static_cast<void (*)(GLbitfield)>(clear)));
  ASSERT_NE(table.Clear, nullptr);
  table.Clear(0);
  EXPECT_EQ(cleared, 1);
  EXPECT_EQ(slot(table, CallId::Clear), reinterpret_cast<AnyFunction>(table.Clear));

  // First and last slot, to detect a registry and a header with different orders.
  DispatchTable ends{};
  set_slot(ends, static_cast<CallId>(0),
           reinterpret_cast<AnyFunction>(static_cast<void (*)(GLbitfield)>(clear)));
  EXPECT_NE(ends.Accum, nullptr);
  EXPECT_EQ(call_name(static_cast<CallId>(0)), std::string("glAccum"));
}

}  // namespace
