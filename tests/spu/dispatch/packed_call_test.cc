#include "dispatch/packed_call.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <vector>

namespace {

using namespace understudy::spu;

PackedCalls sink;
struct IntoSink {
  static PackedCalls& sink() { return ::sink; }
};

const DispatchTable& packing_table() {
  static const DispatchTable table = [] {
    DispatchTable filled{};
    PackInto<IntoSink>::fill(filled);
    return filled;
  }();
  return table;
}

/// Replays a stream into a fresh one.
std::vector<std::uint64_t> repacked(std::span<const std::uint64_t> words) {
  sink.clear();
  const ReplayEnd end = replay(words, packing_table());
  EXPECT_EQ(end.error, nullptr) << end.error;
  return {sink.words().begin(), sink.words().end()};
}

std::uint64_t header(CallId call, std::uint16_t words) {
  const RecordHeader record{static_cast<std::uint16_t>(call), words};
  std::uint64_t word = 0;
  std::memcpy(&word, &record, sizeof record);
  return word;
}

TEST(PackedCall, ArgumentsArriveAsTheyWereGiven) {
  PackedCalls calls;
  const GLdouble vertex[3] = {1.5, -2.25, 1e300};
  const GLubyte colour[4] = {1, 2, 254, 255};
  GLfloat matrix[16];
  for (int i = 0; i < 16; ++i) matrix[i] = static_cast<GLfloat>(i) / 10.0f;
  pack_Begin(calls, GL_QUADS);
  pack_Vertex3dv(calls, vertex);
  pack_Color4ubv(calls, colour);
  pack_LoadMatrixf(calls, matrix);
  pack_TexCoord3f(calls, 0.25f, 0.5f, 0.75f);
  pack_DepthRange(calls, 0.125, 0.875);
  pack_Uniform3i(calls, -1, 2, -3, 4);
  pack_End(calls);

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

  const ReplayEnd end = replay(calls, table);
  EXPECT_EQ(end.error, nullptr);
  EXPECT_EQ(end.calls, 8u);
  EXPECT_EQ(end.words, calls.words().size());
  const std::vector<double> expected{GL_QUADS, 1.5,  -2.25, 1e300, 1,  2, 254, 255, 1.5, 0.25,
                                     0.5,      0.75, 0.125, 0.875, -1, 2, -3,  4,   7};
  EXPECT_EQ(seen, expected);
}

TEST(PackedCall, ACallThatTheTableLacksEndsTheReplay) {
  PackedCalls calls;
  pack_End(calls);
  EXPECT_STREQ(replay(calls, DispatchTable{}).error, "the table to replay on lacks the record's call");
}

// Chromium tested every call with hand-written values; here the values are random and the specification is the
// registry, so the test grows with it.
TEST(PackedCall, EveryPackableCommandSurvivesPackingReplayAndPackingAgain) {
  const unsigned seed = std::random_device{}();
  std::printf("seed %u\n", seed);
  std::mt19937_64 random(seed);
  std::size_t packable = 0;
  for (std::size_t number = 0; number < call_count; ++number) {
    const auto call = static_cast<CallId>(number);
    EXPECT_EQ(is_packable(call), slot(packing_table(), call) != nullptr) << call_name(call);
    if (!is_packable(call)) continue;
    ++packable;
    std::array<std::uint64_t, 32> record;
    std::generate(record.begin(), record.end(), random);
    int accepted = 0;
    for (std::uint16_t words = 1; words <= record.size(); ++words) {
      const std::uint64_t arguments_in_header = record[0] & ~std::uint64_t{0xffffffff};
      record[0] = arguments_in_header | header(call, words);
      sink.clear();
      if (replay(std::span(record).first(words), packing_table()).error != nullptr) continue;
      ++accepted;
      const std::vector<std::uint64_t> first{sink.words().begin(), sink.words().end()};
      ASSERT_EQ(first.size(), words) << call_name(call);
      EXPECT_EQ(static_cast<std::uint32_t>(first[0]), static_cast<std::uint32_t>(record[0])) << call_name(call);
      EXPECT_EQ(repacked(first), first) << call_name(call);
    }
    EXPECT_EQ(accepted, 1) << call_name(call) << " has one length";
  }
  std::printf("%zu of %zu commands are packable\n", packable, call_count);
  EXPECT_GT(packable, 1500u);
}

TEST(PackedCall, CommandsWithAnswersAddressesOrOpenLengthsAreNotPackable) {
  for (const CallId call :
       {CallId::GetError, CallId::GenTextures, CallId::TexImage3D, CallId::DrawElements, CallId::VertexPointer,
        CallId::DeleteSync, CallId::DebugMessageCallback, CallId::ShaderSource,
        CallId::ProgramNamedParameter4fvNV, CallId::ReadPixels, CallId::TexParameterfv}) {
    EXPECT_FALSE(is_packable(call)) << call_name(call);
  }
  EXPECT_FALSE(is_packable(static_cast<CallId>(call_count)));
}

TEST(PackedCall, ReplayBelievesNoWrongRecord) {
  const auto error_of = [](std::vector<std::uint64_t> words) {
    const ReplayEnd end = replay(words, packing_table());
    EXPECT_EQ(end.calls, 0u);
    EXPECT_EQ(end.words, 0u);
    return std::string(end.error != nullptr ? end.error : "");
  };
  EXPECT_EQ(error_of({header(static_cast<CallId>(call_count), 1)}),
            "the record's call number is not in this registry");
  EXPECT_EQ(error_of({header(static_cast<CallId>(0xffff), 1)}),
            "the record's call number is not in this registry");
  EXPECT_EQ(error_of({header(CallId::GenTextures, 1)}), "the record's call cannot be packed");
  EXPECT_EQ(error_of({header(CallId::End, 0)}), "the record's length is not that of its call");
  EXPECT_EQ(error_of({header(CallId::End, 2), 0}), "the record's length is not that of its call");
  EXPECT_EQ(error_of({header(CallId::Vertex3dv, 4), 0, 0}), "the stream ends within the record");
}

TEST(PackedCall, AReplayThatStopsSaysWhere) {
  PackedCalls calls;
  pack_Vertex3f(calls, 1, 2, 3);
  pack_End(calls);
  const std::size_t good = calls.words().size();
  const std::uint64_t bad[] = {header(CallId::GetError, 1)};
  calls.append(bad);
  const ReplayEnd end = replay(calls, packing_table());
  EXPECT_NE(end.error, nullptr);
  EXPECT_EQ(end.calls, 2u);
  EXPECT_EQ(end.words, good);
}

TEST(PackedCall, AnEmptyStreamIsFine) {
  const ReplayEnd end = replay(PackedCalls{}, DispatchTable{});
  EXPECT_EQ(end.error, nullptr);
  EXPECT_EQ(end.calls, 0u);
}

}  // namespace
