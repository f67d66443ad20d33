// SPDX-License-Identifier: Apache-2.0
// Malformed streams cause an error that names the position, never a crash, a hang or more memory than the file
// may request. tests/fuzz searches for more of them.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "spu/stream/decode.h"
#include "spu/stream/encode.h"
#include "spu/stream/event.h"
#include "spu/stream/trace_file.h"
#include "tests/fuzz/played_input.h"
#include "tests/spu/stream/any_call.h"
#include "tests/spu/stream/reading_driver.h"
#include "tests/spu/stream/stateful_driver.h"

namespace understudy::spu::testing {
namespace {

namespace fs = std::filesystem;

/// One record of every command.
Records every_command(const DispatchTable& questions) {
  std::mt19937 random(99);
  Records records;
  Encoder encoder(questions, [] {});
  for (std::size_t i = 0; i < call_count; ++i)
    encoder.encode(CallId(i), AnyCall(CallId(i), random).words(), records);
  return records;
}

/// Plays all records that can be played; returns how many were refused.
std::size_t play_untrusted(std::span<const std::uint64_t> words, std::span<const std::uint64_t> payload,
                           const DispatchTable& gl) {
  Decoder decoder(StreamOrigin::elsewhere, std::make_shared<ObjectNames>());
  std::size_t refused = 0;
  for (std::size_t at = 0; at < words.size();) {
    const auto record = record_at(words, at, payload);
    if (!record) return refused + 1;
    refused += decoder.decode(*record, gl).error.empty() ? 0 : 1;
    at += record->words.size();
  }
  return refused;
}

class Damage : public ::testing::Test {
 protected:
  Damage() { driver.counts_only = true; }

  StatefulDriver driver;
};

TEST_F(Damage, EveryRecordCutAtEveryWord) {
  const Records records = every_command(driver.table());
  std::size_t cut = 0;
  std::size_t refused = 0;
  for (std::size_t at = 0; at < records.words().size();) {
    const auto record = record_at(records.words(), at, records.payload());
    ASSERT_TRUE(record);
    for (std::size_t length = 1; length < record->words.size(); ++length) {
      // The header states the shortened length, so that only arguments are missing.
      std::vector<std::uint64_t> words(record->words.begin(), record->words.begin() + std::ptrdiff_t(length));
      words[0] = record->id | std::uint64_t(length) << 32;
      refused += play_untrusted(words, {}, driver.table());
      ++cut;
    }
    at += record->words.size();
  }
  std::printf("%zu cut records, %zu refused\n", cut, refused);
  EXPECT_GT(refused, cut / 4);
}

TEST_F(Damage, EveryWordOfEveryRecordReplacedByExtremes) {
  const Records records = every_command(driver.table());
  constexpr std::array<std::uint64_t, 8> extremes = {
      0, ~std::uint64_t(0), std::uint64_t(1) << 63, 0x7fff'ffff, 0x8000'0000,
      // References to just behind the record, to the payload's end, and far away.
      Reference{ReferenceKind::inside, 0xffff'ffff}.word(), Reference{ReferenceKind::payload, 1}.word(),
      Reference{ReferenceKind::strings, 2}.word()};
  std::vector<std::uint64_t> words(records.words().begin(), records.words().end());
  const std::vector<std::uint64_t> payload(records.payload().begin(), records.payload().end());
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t length = words[at] >> 32;
    for (std::size_t w = 1; w < length; ++w) {
      const std::uint64_t kept = words[at + w];
      for (const std::uint64_t extreme : extremes) {
        words[at + w] = extreme;
        play_untrusted(std::span(words).subspan(at, length), payload, driver.table());
      }
      words[at + w] = kept;
    }
    at += length;
  }
}

TEST_F(Damage, TwentyThousandMutations) {
  const Records records = every_command(driver.table());
  std::mt19937 random(4711);
  std::vector<std::uint64_t> words(records.words().begin(), records.words().end());
  for (int mutation = 0; mutation < 20'000; ++mutation) {
    const std::size_t at = random() % words.size();
    const std::uint64_t kept = words[at];
    words[at] ^= std::uint64_t(1) << random() % 64;
    if (random() % 4 == 0) words[at] = random();
    const std::size_t from = at - std::min<std::size_t>(at, random() % 64);
    play_untrusted(std::span(words).subspan(from, std::min<std::size_t>(words.size() - from, 200)), {},
                   driver.table());
    words[at] = kept;
  }
}

TEST_F(Damage, UnknownIdsAreNamed) {
  Records records;
  records.append_plain(stable_id_of("glFromTheFuture"), {});
  const auto record = record_at(records.words(), 0, {});
  Decoder decoder(StreamOrigin::elsewhere, nullptr);
  EXPECT_NE(decoder.decode(*record, driver.table()).error.find("not in this registry"), std::string::npos);
}

TEST_F(Damage, PixelsThatAreNotThereAreRefused) {
  // An image of 2^15 cubed texels with only three bytes of data.
  Records records;
  records.begin(stable_id(CallId::TexImage3D));
  for (const std::uint64_t word :
       {GL_TEXTURE_3D, 0, GL_RGBA8, 32768, 32768, 32768, 0, GL_RGBA, GL_UNSIGNED_BYTE, 0})
    records.append(word);
  const std::array<std::byte, 3> little{};
  records.set(10, records.attach(little).word());
  const auto record = record_at(records.words(), 0, records.payload());
  Decoder decoder(StreamOrigin::elsewhere, nullptr);
  const Decoded decoded = decoder.decode(*record, driver.table());
  EXPECT_NE(decoded.error.find("pixels needs"), std::string::npos) << decoded.error;
  EXPECT_EQ(driver.counted, 0U);
}

TEST_F(Damage, AddressesOfElsewhereNeverReachOpenGl) {
  Records records;
  // No buffer is bound, so the word is an address in some process's memory.
  records.append_plain(stable_id(CallId::VertexPointer),
                       {{3, GL_FLOAT, 0, Reference{ReferenceKind::address, 0xdead'beef}.word()}});
  const std::uint64_t draw[] = {GL_TRIANGLES, 3, GL_UNSIGNED_INT,
                                Reference{ReferenceKind::address, 0xdead'beef}.word()};
  records.append_plain(stable_id(CallId::DrawElements), draw);
  driver.counts_only = false;
  EXPECT_EQ(play_untrusted(records.words(), {}, driver.table()), 1U)
      << "the indices are an offset without a buffer";
  ASSERT_EQ(driver.calls().size(), 1U);
  EXPECT_EQ(driver.calls()[0].call, CallId::VertexPointer);
}

TEST_F(Damage, TheKeptCorpusIsPlayed) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(FUZZ_CORPUS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    play_input<ReadingDriver>(std::as_bytes(std::span(text)));
    ++files;
  }
  std::printf("%d files\n", files);
  EXPECT_GT(files, 10);
}

class DamagedFile : public Damage {
 protected:
  DamagedFile() : path(fs::temp_directory_path() / ("damage_test_" + std::to_string(::getpid()) + ".ust")) {
    Records records;
    std::mt19937 random(5);
    Encoder encoder(driver.table(), [] {});
    TraceWriter writer(path);
    for (const CallId call : {CallId::Clear, CallId::TexImage2D, CallId::ShaderSource, CallId::Vertex3f}) {
      encoder.encode(call, AnyCall(call, random).words(), records);
      records.append_plain(event::frame, {{1, 4, 4}});
      writer.write(records, 1);
      records.clear();
    }
    std::ifstream file(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    bytes.resize(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
  }
  ~DamagedFile() override { fs::remove(path); }

  /// Number of complete blocks that can be read; -1 on error.
  static int blocks_of(std::span<const std::byte> file, std::string* error = nullptr) {
    int blocks = 0;
    try {
      TraceReader reader(file);
      while (reader.next()) ++blocks;
    } catch (const std::runtime_error& trouble) {
      if (error != nullptr) *error = trouble.what();
      return -1;
    }
    return blocks;
  }

  fs::path path;
  std::vector<std::byte> bytes;
};

TEST_F(DamagedFile, CutAtEveryByteReadsUpToTheLastWholeBlock) {
  int last = 0;
  for (std::size_t length = 32; length <= bytes.size(); ++length) {
    const int blocks = blocks_of(std::span(bytes).first(length));
    ASSERT_GE(blocks, last) << "cut at byte " << length;
    last = blocks;
  }
  EXPECT_EQ(last, 4);
  for (std::size_t length = 0; length < 32; ++length) EXPECT_EQ(blocks_of(std::span(bytes).first(length)), -1);
}

TEST_F(DamagedFile, EveryByteTurnedRoundIsNoticed) {
  std::vector<std::byte> file = bytes;
  for (std::size_t at = 0; at < file.size(); ++at) {
    file[at] ^= std::byte(0xff);
    std::string error;
    const int blocks = blocks_of(file, &error);
    // Twelve bytes of the file's header and sixteen of each block's header are unused so far.
    if (blocks == -1) {
      EXPECT_TRUE(at < 32 || error.find("at byte") != std::string::npos) << error;
    }
    file[at] ^= std::byte(0xff);
  }
}

TEST_F(DamagedFile, VersionsFromTheFutureAreNamed) {
  std::vector<std::byte> file = bytes;
  file[16] = std::byte(200);
  std::string error;
  EXPECT_EQ(blocks_of(file, &error), -1);
  EXPECT_NE(error.find("version 200"), std::string::npos) << error;
}

TEST_F(DamagedFile, LengthsOfTwoToThe63AreNotBelieved) {
  for (const std::size_t field : {16U, 24U, 32U}) {
    std::vector<std::byte> file = bytes;
    const std::uint64_t huge = std::uint64_t(1) << 63;
    std::memcpy(file.data() + 32 + field, &huge, sizeof huge);
    std::string error;
    EXPECT_EQ(blocks_of(file, &error), -1);
    EXPECT_NE(error.find("block 0 at byte 32"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace understudy::spu::testing
