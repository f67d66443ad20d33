// SPDX-License-Identifier: Apache-2.0
// Every command of the registry through the stream and back: OpenGL sees the same call.
#include <gtest/gtest.h>

#include <random>

#include "dispatch/call_words.h"
#include "spu/stream/decode.h"
#include "spu/stream/encode.h"
#include "tests/spu/stream/any_call.h"
#include "tests/spu/stream/stateful_driver.h"

namespace understudy::spu::testing {
namespace {

/// Plays all of `records`; returns the first error.
std::string play(Decoder& decoder, const Records& records, const DispatchTable& gl) {
  for (std::size_t at = 0; at < records.words().size();) {
    const auto record = record_at(records.words(), at, records.payload());
    if (!record) return "no record";
    const Decoded decoded = decoder.decode(*record, gl);
    if (!decoded.error.empty()) return decoded.error;
    at += record->words.size();
  }
  return {};
}

class RoundTrip : public ::testing::Test {
 protected:
  /// Compares what OpenGL sees of the call made directly and through the stream.
  void expect_same(CallId call, const std::uint64_t* words) {
    driver.forget();
    invoke(driver.table(), call, words);
    const SeenCall direct = driver.calls().front();
    driver.forget();
    Records records;
    Encoder encoder(driver.table(), [] {});
    encoder.encode(call, words, records);
    Decoder decoder;
    ASSERT_EQ(play(decoder, records, driver.table()), "") << text(direct);
    ASSERT_EQ(driver.calls().size(), 1U) << text(direct);
    EXPECT_EQ(driver.calls().front(), direct) << text(direct) << " became " << text(driver.calls().front());
  }

  StatefulDriver driver;
};

TEST_F(RoundTrip, EveryCommandIsSeenTheSame) {
  std::mt19937 random(20021124);
  for (std::size_t i = 0; i < call_count; ++i) {
    const auto call = CallId(i);
    // The stateful driver answers these itself.
    if (call == CallId::GetIntegerv || call == CallId::PixelStorei || call == CallId::IsEnabled) continue;
    for (int repetition = 0; repetition < 2; ++repetition) {
      const AnyCall arguments(call, random);
      ASSERT_NO_FATAL_FAILURE(expect_same(call, arguments.words()));
    }
  }
}

TEST_F(RoundTrip, PixelsUnderEveryUnpackSetting) {
  std::mt19937 random(7);
  for (int repetition = 0; repetition < 300; ++repetition) {
    constexpr std::array<GLint, 4> alignments = {1, 2, 4, 8};
    driver.set(GL_UNPACK_ALIGNMENT, alignments[random() % 4]);
    driver.set(GL_UNPACK_ROW_LENGTH, random() % 2 == 0 ? 0 : GLint(random() % 9));
    driver.set(GL_UNPACK_IMAGE_HEIGHT, random() % 2 == 0 ? 0 : GLint(random() % 9));
    driver.set(GL_UNPACK_SKIP_PIXELS, GLint(random() % 4));
    driver.set(GL_UNPACK_SKIP_ROWS, GLint(random() % 4));
    driver.set(GL_UNPACK_SKIP_IMAGES, GLint(random() % 4));
    driver.set(GL_UNPACK_SWAP_BYTES, GLint(random() % 2));
    driver.set(GL_UNPACK_LSB_FIRST, GLint(random() % 2));
    for (const CallId call : {CallId::TexImage1D, CallId::TexSubImage2D, CallId::TexImage3D, CallId::DrawPixels,
                              CallId::Bitmap, CallId::PolygonStipple, CallId::TextureSubImage3D}) {
      const AnyCall arguments(call, random);
      ASSERT_NO_FATAL_FAILURE(expect_same(call, arguments.words()));
    }
  }
}

TEST_F(RoundTrip, OffsetsIntoBuffersStayOffsets) {
  driver.set(GL_PIXEL_UNPACK_BUFFER_BINDING, 5);
  const std::uint64_t words[] = {GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, 4096};
  Records records;
  Encoder encoder(driver.table(), [] {});
  encoder.encode(CallId::TexImage2D, words, records);
  const auto record = record_at(records.words(), 0, records.payload());
  ASSERT_TRUE(record);
  const Reference reference = Reference::from(record->words[9]);
  EXPECT_EQ(reference.kind, ReferenceKind::address);
  EXPECT_EQ(reference.value, 4096U);
  EXPECT_EQ(record->words.size(), 10U);
}

TEST_F(RoundTrip, AddressesKeepTheirSign) {
  for (const std::uint64_t value :
       {std::uint64_t(0), std::uint64_t(1), std::uint64_t(0x7fff'ffff'f000), ~std::uint64_t(0)}) {
    EXPECT_EQ(Reference::from((Reference{ReferenceKind::address, value}).word()).value, value);
  }
}

TEST_F(RoundTrip, ManyBytesGoToThePayload) {
  std::vector<std::byte> data(100'000, std::byte(9));
  const std::uint64_t words[] = {GL_ARRAY_BUFFER, data.size(), reinterpret_cast<std::uintptr_t>(data.data()),
                                 GL_STATIC_DRAW};
  Records records;
  Encoder encoder(driver.table(), [] {});
  encoder.encode(CallId::BufferData, words, records);
  EXPECT_EQ(records.words().size(), 5U);
  EXPECT_EQ(records.payload().size(), 1 + data.size() / 8);
  EXPECT_NO_FATAL_FAILURE(expect_same(CallId::BufferData, words));
}

TEST_F(RoundTrip, StableIdsAreMadeFromNames) {
  EXPECT_EQ(stable_id(CallId::Clear), stable_id_of("glClear"));
  for (std::size_t i = 0; i < call_count; ++i) {
    ASSERT_EQ(stable_id(CallId(i)), stable_id_of(call_name(CallId(i))));
    ASSERT_EQ(find_stable_id(stable_id(CallId(i))), CallId(i));
  }
  EXPECT_FALSE(find_stable_id(stable_id_of("glNoSuchCommand")));
}

TEST_F(RoundTrip, QuestionsComeAfterWhatWasPacked) {
  int asked = 0;
  Records records;
  Encoder encoder(driver.table(), [&] { ++asked; });
  const std::uint64_t vertex[] = {0, 0, 0};
  encoder.encode(CallId::Vertex3f, vertex, records);
  EXPECT_EQ(asked, 0);
  const std::uint64_t words[] = {GL_TEXTURE_2D, 0, GL_RGBA8, 4, 4, 0, GL_RGBA, GL_UNSIGNED_BYTE, 0};
  encoder.encode(CallId::TexImage2D, words, records);
  EXPECT_GT(asked, 0);
}

}  // namespace
}  // namespace understudy::spu::testing
