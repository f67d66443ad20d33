// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/plain_calls.h"

#include <gtest/gtest.h>

#include <random>
#include <string_view>
#include <vector>

#include "dispatch/call_shape.h"
#include "tests/spu/stream/any_call.h"

namespace understudy::spu::testing {
namespace {

Records sink;
struct IntoSink {
  static constexpr bool chooses(std::string_view) { return true; }
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    append_plain_call(sink, call, words);
    return 0;
  }
};

/// Functions that append their call to `sink`.
const DispatchTable& appending_table() {
  static const DispatchTable table = [] {
    DispatchTable filled{};
    AsWords<IntoSink>::fill_chosen(filled);
    return filled;
  }();
  return table;
}

std::vector<std::uint64_t> copy(const Records& records) {
  return {records.words().begin(), records.words().end()};
}

/// The records that result from making the calls and recording them again.
std::vector<std::uint64_t> recorded_again(const std::vector<std::uint64_t>& words) {
  sink.clear();
  EXPECT_EQ(make_plain_calls(words, appending_table()), words.size());
  return copy(sink);
}

TEST(PlainCalls, ArgumentsArriveAsTheyWereGiven) {
  const GLdouble vertex[3] = {1.5, -2.25, 1e300};
  const GLubyte colour[4] = {1, 2, 254, 255};
  GLfloat matrix[16];
  for (int i = 0; i < 16; ++i) matrix[i] = static_cast<GLfloat>(i) / 10.0F;
  Records calls;
  append_call(calls, &DispatchTable::Begin, GL_QUADS);
  append_call(calls, &DispatchTable::Vertex3dv, vertex);
  append_call(calls, &DispatchTable::Color4ubv, colour);
  append_call(calls, &DispatchTable::LoadMatrixf, matrix);
  append_call(calls, &DispatchTable::TexCoord3f, 0.25F, 0.5F, 0.75F);
  append_call(calls, &DispatchTable::DepthRange, 0.125, 0.875);
  append_call(calls, &DispatchTable::Uniform3i, -1, 2, -3, 4);
  append_call(calls, &DispatchTable::End);

  static std::vector<double> seen;
  seen.clear();
  DispatchTable table{};
  table.Begin = [](GLenum mode) { seen.push_back(mode); };
  table.Vertex3dv = [](const GLdouble* v) { seen.insert(seen.end(), v, v + 3); };
  table.Color4ubv = [](const GLubyte* v) { seen.insert(seen.end(), v, v + 4); };
  table.LoadMatrixf = [](const GLfloat* m) { seen.push_back(m[15]); };
  table.TexCoord3f = [](GLfloat s, GLfloat t, GLfloat r) { seen.insert(seen.end(), {s, t, r}); };
  table.DepthRange = [](GLdouble n, GLdouble f) { seen.insert(seen.end(), {n, f}); };
  table.Uniform3i = [](GLint location, GLint a, GLint b, GLint c) {
    for (const GLint value : {location, a, b, c}) seen.push_back(value);
  };
  table.End = [] { seen.push_back(7); };

  EXPECT_EQ(make_plain_calls(calls.words(), table), calls.words().size());
  const std::vector<double> expected{GL_QUADS, 1.5,  -2.25, 1e300, 1,  2, 254, 255, 1.5, 0.25,
                                     0.5,      0.75, 0.125, 0.875, -1, 2, -3,  4,   7};
  EXPECT_EQ(seen, expected);
}

TEST(PlainCalls, AnArrayThatIsNullStaysNull) {
  static bool null;
  null = false;
  DispatchTable table{};
  table.Vertex3fv = [](const GLfloat* v) { null = v == nullptr; };
  Records calls;
  append_call(calls, &DispatchTable::Vertex3fv, nullptr);
  EXPECT_EQ(make_plain_calls(calls.words(), table), calls.words().size());
  EXPECT_TRUE(null);
}

TEST(PlainCalls, ASlotHasItsNumber) {
  EXPECT_EQ(call_of(&DispatchTable::Accum), CallId::Accum);
  EXPECT_EQ(call_of(&DispatchTable::Vertex3fv), CallId::Vertex3fv);
  EXPECT_EQ(call_of(&DispatchTable::GetError), CallId::GetError);
}

TEST(PlainCalls, EveryPlainCommandSurvivesRecordingAndBeingMadeAgain) {
  std::mt19937 random(1992);
  std::size_t plain = 0;
  for (std::size_t number = 0; number < call_count; ++number) {
    const auto call = static_cast<CallId>(number);
    const CallShape& shape = call_shape(call);
    EXPECT_EQ(shape.plain(), slot(appending_table(), call) != nullptr) << call_name(call);
    if (!shape.plain()) continue;
    ++plain;
    const AnyCall arguments(call, random);
    Records records;
    append_plain_call(records, call, arguments.words());
    const std::vector<std::uint64_t> words = copy(records);
    ASSERT_EQ(words.size(), shape.plain_words) << call_name(call);
    for (std::size_t p = 0; p < shape.parameter_count; ++p) {
      if (shape.parameters()[p].pointer == 0) {
        EXPECT_EQ(words[p + 1], arguments.words()[p]) << call_name(call);
      }
    }
    EXPECT_EQ(recorded_again(words), words) << call_name(call);
  }
  EXPECT_GT(plain, 1500U) << "of " << call_count;
}

TEST(PlainCalls, CommandsWithAnswersAddressesOrOpenLengthsAreNotPlain) {
  for (const CallId call :
       {CallId::GetError, CallId::GenTextures, CallId::TexImage3D, CallId::DrawElements, CallId::VertexPointer,
        CallId::DeleteSync, CallId::DebugMessageCallback, CallId::ShaderSource,
        CallId::ProgramNamedParameter4fvNV, CallId::ReadPixels, CallId::TexParameterfv}) {
    EXPECT_FALSE(call_shape(call).plain()) << call_name(call);
  }
}

TEST(PlainCalls, NoWrongRecordIsBelieved) {
  const auto header = [](std::uint32_t id, std::uint64_t words) { return id | words << 32; };
  const std::uint32_t vertex = stable_id(CallId::Vertex3dv);
  const std::uint64_t inside = Reference{ReferenceKind::inside, 2}.word();
  const std::vector<std::vector<std::uint64_t>> wrong = {
      {header(stable_id_of("glFromTheFuture"), 1)},
      {header(stable_id(CallId::GenTextures), 3), 1, 0},
      {header(stable_id(CallId::End), 0)},
      {header(stable_id(CallId::Begin), 1)},
      {header(stable_id(CallId::Begin), 2)},
      {header(vertex, 6), inside, 24, 0, 0},
      {header(vertex, 5), inside, 24, 0, 0},
      {header(vertex, 5), inside, 16, 0, 0},
      {header(vertex, 2), Reference{ReferenceKind::inside, 0}.word()},
      {header(vertex, 6), Reference{ReferenceKind::inside, 6}.word(), 24, 0, 0, 0},
      {header(vertex, 6), Reference{ReferenceKind::payload, 2}.word(), 24, 0, 0, 0},
      {header(vertex, 6), Reference{ReferenceKind::address, 64}.word(), 24, 0, 0, 0},
      {header(vertex, 6), Reference{ReferenceKind::strings, 64}.word(), 24, 0, 0, 0},
  };
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    sink.clear();
    EXPECT_EQ(make_plain_calls(wrong[i], appending_table()), 0U) << "record " << i;
    EXPECT_TRUE(sink.empty()) << "record " << i;
  }
  EXPECT_EQ(recorded_again({header(vertex, 6), inside, 24, 0, 0, 0}).size(), 6U) << "the right one";
}

TEST(PlainCalls, TheyStopWhereTheTableOrTheStreamHasNoMore) {
  Records calls;
  append_call(calls, &DispatchTable::Vertex3f, 1.0F, 2.0F, 3.0F);
  const std::size_t first = calls.words().size();
  append_call(calls, &DispatchTable::End);
  DispatchTable table = appending_table();
  table.End = nullptr;
  sink.clear();
  EXPECT_EQ(make_plain_calls(calls.words(), table), first);
  EXPECT_EQ(sink.words().size(), first);
  EXPECT_EQ(make_plain_calls({}, DispatchTable{}), 0U);
}

// Runs rely on this: memory is reused, and nothing of its former contents is visible.
TEST(PlainCalls, RecordsThatWereClearedForgetWhatTheyHeld) {
  const GLubyte full[3] = {0xff, 0xff, 0xff};
  const auto record = [&](Records& to) {
    append_call(to, &DispatchTable::Color3ubv, full);
    append_call(to, &DispatchTable::Vertex3fv, nullptr);
    to.begin(stable_id(CallId::Begin));
    to.reserve(2);
  };
  Records fresh;
  record(fresh);
  Records used;
  for (int i = 0; i < 64; ++i) used.append_plain(~0U, std::vector<std::uint64_t>{~std::uint64_t(0)});
  used.clear();
  EXPECT_TRUE(used.empty());
  record(used);
  EXPECT_EQ(copy(used), copy(fresh));
}

}  // namespace
}  // namespace understudy::spu::testing
