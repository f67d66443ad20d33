// SPDX-License-Identifier: Apache-2.0
#include "dispatch/pass_through.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace {

using namespace understudy::spu;

std::vector<CallId> noted;
DispatchTable next{};

struct Note {
  static constexpr bool chooses(std::string_view name) { return name.starts_with("glTexImage"); }
  static const DispatchTable& before(CallId call) {
    noted.push_back(call);
    return next;
  }
};

TEST(PassThrough, DoesOneThingFirstAndForwardsArgumentsAndAnswer) {
  DispatchTable table{};
  PassThrough<Note>::fill(table);
  static double sum = 0;
  next.Vertex3f = [](GLfloat x, GLfloat y, GLfloat z) {
    sum = x + 10 * y + 100 * z + 1000 * static_cast<double>(noted.size());
  };
  next.GetUniformLocation = [](GLuint program, const GLchar* name) {
    return static_cast<GLint>(program) + name[0];
  };
  noted.clear();
  table.Vertex3f(1, 2, 3);
  EXPECT_EQ(sum, 1321) << "noted before it was forwarded";
  EXPECT_EQ(table.GetUniformLocation(5, "a"), 5 + 'a');
  EXPECT_EQ(noted, (std::vector{CallId::Vertex3f, CallId::GetUniformLocation}));
}

TEST(PassThrough, FillsEverySlotWithAFunctionOfItsOwn) {
  DispatchTable table{};
  PassThrough<Note>::fill(table);
  std::vector<AnyFunction> functions;
  for (std::size_t number = 0; number < call_count; ++number) {
    functions.push_back(slot(table, static_cast<CallId>(number)));
    EXPECT_NE(functions.back(), nullptr) << call_name(static_cast<CallId>(number));
  }
  std::sort(functions.begin(), functions.end());
  EXPECT_EQ(std::adjacent_find(functions.begin(), functions.end()), functions.end());
}

TEST(PassThrough, FillsTheChosenSlotsAndLeavesTheOthers) {
  DispatchTable table{};
  PassThrough<Note>::fill_chosen(table);
  for (std::size_t number = 0; number < call_count; ++number) {
    const auto call = static_cast<CallId>(number);
    EXPECT_EQ(slot(table, call) != nullptr, Note::chooses(call_name(call))) << call_name(call);
  }
}

}  // namespace
