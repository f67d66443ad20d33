// SPDX-License-Identifier: Apache-2.0
// Pointers in an untrusted stream: OpenGL gets bytes that came with the stream, memory of this process, or an
// offset within a buffer object, and nothing else.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "dispatch/call_words.h"
#include "spu/stream/decode.h"
#include "spu/stream/encode.h"
#include "spu/stream/event.h"
#include "tests/spu/stream/any_call.h"
#include "tests/spu/stream/reading_driver.h"

namespace understudy::spu::testing {
namespace {

constexpr std::uint64_t evil = 0x4142'4344'4000;

/// Notes whether a pointer argument equals the address that the stream contained.
struct Watched {
  static inline thread_local bool evil_seen = false;
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    const auto parameters = call_shape(call).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p)
      evil_seen |= parameters[p].pointer > 0 && words[p] == evil;
    return 0;
  }
};

class Pointers : public ::testing::TestWithParam<StreamOrigin> {
 protected:
  Decoder decoder{GetParam(), std::make_shared<ObjectNames>()};
  ReadingDriver driver;

  std::string play(const Records& records, const DispatchTable& gl) {
    std::string errors;
    for (std::size_t at = 0; at < records.words().size();) {
      const auto record = record_at(records.words(), at, records.payload());
      if (!record) return errors + "no record";
      errors += decoder.decode(*record, gl).error;
      at += record->words.size();
    }
    return errors;
  }
  std::string play(const Records& records) { return play(records, driver.table()); }
  /// Makes a call with values only; references are passed unchanged.
  std::string make(CallId call, std::vector<std::uint64_t> words) {
    Records records;
    records.append_plain(stable_id(call), words);
    return play(records);
  }
  std::string make_with(CallId call, std::vector<std::uint64_t> words, std::size_t at,
                        std::span<const std::byte> data) {
    Records records;
    records.append_plain(stable_id(call), words);
    records.set(at + 1, records.attach(data).word());
    return play(records);
  }
  void bind(GLenum target, GLuint name, std::uint64_t bytes) {
    make(CallId::BindBuffer, {target, name});
    make(CallId::BufferData, {target, bytes, 0, GL_STATIC_DRAW});
  }
};

constexpr std::uint64_t address_word(std::uint64_t value) {
  return Reference{ReferenceKind::address, value}.word();
}

TEST_P(Pointers, NoCommandIsHandedAnAddress) {
  DispatchTable watched{};
  AsWords<Watched>::fill(watched);
  std::mt19937 random(3);
  Watched::evil_seen = false;
  for (std::size_t i = 0; i < call_count; ++i) {
    Records records;
    Encoder encoder(driver.table(), [] {});
    encoder.encode(CallId(i), AnyCall(CallId(i), random).words(), records);
    const auto parameters = call_shape(CallId(i)).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (parameters[p].pointer == 0) continue;
      for (const ReferenceKind kind : {ReferenceKind::address, ReferenceKind::output}) {
        std::vector<std::uint64_t> words(records.words().begin(), records.words().end());
        words[p + 1] = Reference{kind, evil}.word();
        decoder.decode(*record_at(words, 0, records.payload()), watched);
        ASSERT_FALSE(Watched::evil_seen) << call_name(CallId(i)) << ", " << parameters[p].name();
      }
    }
  }
}

TEST_P(Pointers, NoCommandFollowsANullPointer) {
  std::mt19937 random(4);
  for (std::size_t i = 0; i < call_count; ++i) {
    if (CallId(i) == CallId::Begin) continue;
    Records records;
    Encoder encoder(driver.table(), [] {});
    encoder.encode(CallId(i), AnyCall(CallId(i), random).words(), records);
    const auto parameters = call_shape(CallId(i)).parameters();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (parameters[p].pointer == 0) continue;
      std::vector<std::uint64_t> words(records.words().begin(), records.words().end());
      words[p + 1] = 0;
      decoder.decode(*record_at(words, 0, records.payload()), driver.table());
    }
  }
  EXPECT_GT(driver.calls(), 100U);
}

TEST_P(Pointers, AnErrorNamesTheCall) {
  EXPECT_EQ(make(CallId::BufferData, {GL_ARRAY_BUFFER, 4096, address_word(evil), GL_STATIC_DRAW}),
            "glBufferData: data is an address of another process");
  EXPECT_EQ(make(CallId::LoadMatrixf, {0}), "glLoadMatrixf: m is a null pointer");
}

TEST_P(Pointers, StringsAreNoAddresses) {
  const std::array<std::uint64_t, 1> list = {evil};
  EXPECT_EQ(make_with(CallId::ShaderSource, {1, 1, 0, 0}, 2, std::as_bytes(std::span(list))),
            "glShaderSource: string is data of another kind than the call reads");
}

TEST_P(Pointers, OffsetsStayWithinTheirBuffer) {
  bind(GL_PIXEL_UNPACK_BUFFER, 5, 64);
  const auto upload = [&](std::uint64_t offset) {
    return make(CallId::TexImage2D,
                {GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, address_word(offset)});
  };
  EXPECT_EQ(upload(0), "");
  EXPECT_EQ(upload(1), "glTexImage2D: pixels goes beyond the buffer: 64 bytes at 1 of 64");
  EXPECT_NE(upload(~std::uint64_t(0) >> 9), "");
  make(CallId::PixelStorei, {GL_UNPACK_SKIP_ROWS, 1});
  EXPECT_NE(upload(0), "");
}

TEST_P(Pointers, IndicesStayWithinTheirBuffer) {
  bind(GL_ELEMENT_ARRAY_BUFFER, 5, 24);
  EXPECT_EQ(make(CallId::DrawElements, {GL_TRIANGLES, 3, GL_UNSIGNED_INT, address_word(12)}), "");
  EXPECT_NE(make(CallId::DrawElements, {GL_TRIANGLES, 4, GL_UNSIGNED_INT, address_word(12)}), "");
}

TEST_P(Pointers, BytesOfTheStreamAreNoOffset) {
  bind(GL_ELEMENT_ARRAY_BUFFER, 5, 24);
  const std::array<std::byte, 12> indices{};
  EXPECT_EQ(make_with(CallId::DrawElements, {GL_TRIANGLES, 3, GL_UNSIGNED_INT, 0}, 3, indices),
            "glDrawElements: indices is memory, but a buffer is bound");
}

TEST_P(Pointers, PixelsAreReadTightWhateverTheStreamTookForABegin) {
  make(CallId::PixelStorei, {GL_UNPACK_SKIP_ROWS, 1 << 20});
  // OpenGL refuses this mode, so no primitive has begun.
  make(CallId::Begin, {0xffff});
  const std::array<std::byte, 64> pixels{};
  EXPECT_EQ(make_with(CallId::TexImage2D, {GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, 0},
                      8, pixels),
            "");
}

TEST_P(Pointers, AnOffsetWhoseBufferIsDeletedIsNotDrawnFrom) {
  bind(GL_ARRAY_BUFFER, 5, 64);
  make(CallId::VertexPointer, {3, GL_FLOAT, 0, address_word(evil)});
  make(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  const std::array<GLuint, 1> names = {5};
  EXPECT_EQ(make_with(CallId::DeleteBuffers, {1, 0}, 1, std::as_bytes(std::span(names))), "");
  EXPECT_EQ(make(CallId::DrawArrays, {GL_POINTS, 0, 3}),
            "glDrawArrays: reads elements of vertex arrays that did not come with it");
}

TEST_P(Pointers, AnArrayThatIsKeptBeyondItsRecordIsACopy) {
  make(CallId::EnableClientState, {GL_VERTEX_ARRAY});
  {
    const std::array<GLfloat, 9> vertices{};
    Records records;
    append_arrays(
        {{.role = ArrayRole::vertex, .size = 3, .pointer = reinterpret_cast<std::uintptr_t>(vertices.data())}},
        {.first = 0, .last = 2}, records);
    EXPECT_EQ(play(records), "");
  }
  EXPECT_EQ(make(CallId::DrawArrays, {GL_POINTS, 0, 3}), "");
  EXPECT_NE(make(CallId::DrawArrays, {GL_POINTS, 1, 3}), "");
  EXPECT_NE(make(CallId::VertexPointer, {3, GL_FLOAT, 400, 0}), "") << "between the arrays and their end";
}

TEST_P(Pointers, WhatIsMappedNoMoreIsNotWrittenTo) {
  bind(GL_ARRAY_BUFFER, 5, 64);
  const auto map = [&] {
    make(CallId::MapBuffer, {GL_ARRAY_BUFFER, GL_WRITE_ONLY});
    Records records;
    const std::array<std::uint64_t, 2> answer = {stable_id(CallId::MapBuffer), 0x1000};
    records.append_plain(event::answers, answer);
    play(records);
  };
  const auto write = [&] {
    const std::array<std::byte, 16> data{};
    Records records;
    records.append_plain(event::mapped_write, {{0x1000, 0, 0}});
    records.set(3, records.attach(data).word());
    return play(records);
  };
  map();
  EXPECT_EQ(write(), "");
  make(CallId::NamedBufferStorage, {5, 32, 0, 0});
  EXPECT_EQ(write(), "");
  map();
  make(CallId::UnmapBufferOES, {GL_ARRAY_BUFFER});
  EXPECT_EQ(write(), "");
}

TEST_P(Pointers, AMappingOutlastsOtherBuffers) {
  bind(GL_COPY_READ_BUFFER, 6, 64);
  bind(GL_ARRAY_BUFFER, 5, 64);
  make(CallId::MapBuffer, {GL_ARRAY_BUFFER, GL_WRITE_ONLY});
  Records records;
  const std::array<std::uint64_t, 2> answer = {stable_id(CallId::MapBuffer), 0x1000};
  records.append_plain(event::answers, answer);
  const std::array<GLuint, 1> others = {6};
  records.append_plain(stable_id(CallId::DeleteBuffers), {{1, 0}});
  records.set(2, records.attach(std::as_bytes(std::span(others))).word());
  const std::array<std::byte, 1> data = {std::byte(9)};
  records.append_plain(event::mapped_write, {{0x1000, 3, 0}});
  records.set(3, records.attach(data).word());
  EXPECT_EQ(play(records), "");
  void* mapped = nullptr;
  driver.table().GetBufferPointerv(GL_ARRAY_BUFFER, GL_BUFFER_MAP_POINTER, &mapped);
  ASSERT_NE(mapped, nullptr);
  EXPECT_EQ(static_cast<const std::byte*>(mapped)[3], std::byte(9));
}

TEST(MappingNames, AreThoseOfOneMappingOfABuffer) {
  ObjectNames names;
  std::array<std::byte, 64> memory{};
  names.set_mapping(0x1000, {memory.data(), 64, 5});
  names.set_mapping(0x2000, {memory.data(), 16, 5});
  EXPECT_EQ(names.mapping(0x1000).first, nullptr) << "its size was another";
  EXPECT_EQ(names.mapping(0x2000).bytes, 16U);
}

TEST_P(Pointers, FeedbackGoesToMemoryOfOurs) {
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(make(CallId::FeedbackBuffer, {1000, GL_2D, Reference{ReferenceKind::output, evil}.word()}), "");
  make(CallId::RenderMode, {GL_FEEDBACK});
  EXPECT_EQ(make(CallId::FeedbackBuffer, {1, GL_2D, Reference{ReferenceKind::output, evil}.word()}), "");
  make(CallId::RenderMode, {GL_RENDER});
}

INSTANTIATE_TEST_SUITE_P(From, Pointers, ::testing::Values(StreamOrigin::elsewhere, StreamOrigin::linked));

}  // namespace
}  // namespace understudy::spu::testing
