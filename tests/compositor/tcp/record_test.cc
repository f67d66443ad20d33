// SPDX-License-Identifier: Apache-2.0
// Records of an encrypted session: what was sealed is recovered, and nothing else is opened.
#include "compositor/transport/tcp/record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "compositor/transport/tcp/record_opener.h"
#include "compositor/transport/tcp/record_sealer.h"
#include "compositor/transport/wire.h"
#include "tests/compositor/tcp/session.h"

namespace understudy::compositor::testing {
namespace {

using RecordBytes = std::vector<std::byte>;
using ::testing::HasSubstr;

RecordBytes noise(std::size_t size, unsigned seed = 1) {
  RecordBytes bytes(size);
  std::generate(bytes.begin(), bytes.end(),
                [random = std::mt19937(seed)]() mutable { return std::byte(random()); });
  return bytes;
}

/// Returns the content of the records in `line`, which is read in pieces of at most `most` bytes.
RecordBytes opened(RecordOpener& opener, std::span<const std::byte> line, std::size_t most = 1 << 20) {
  RecordBytes all;
  while (!line.empty()) {
    const std::span<std::byte> room = opener.room();
    const std::size_t count = std::min({room.size(), most, line.size()});
    std::ranges::copy(line.first(count), room.begin());
    line = line.subspan(count);
    if (!opener.took(count)) continue;
    const std::size_t before = all.size();
    all.resize(before + opener.plain_bytes());
    opener.open(std::span(all).subspan(before));
  }
  return all;
}

class RecordTest : public ::testing::Test {
 protected:
  RecordBytes sealed(const RecordBytes& plain) {
    const auto record = sealer_.seal(plain);
    return {record.begin(), record.end()};
  }
  /// Returns why an opener refuses `line`; empty if it does not.
  static std::string refusal(RecordOpener& opener, const RecordBytes& line) {
    try {
      opened(opener, line);
    } catch (const MalformedMessage& error) {
      return error.what();
    }
    return {};
  }

  const Credentials secret_ = secret_of("sixteen bytes or more");
  const std::pair<SessionKeys, SessionKeys> keys_ = keys_of_session(secret_);
  RecordSealer sealer_{keys_.first.send};
  RecordOpener opener_{keys_.second.receive};
};

TEST_F(RecordTest, GiveBackWhatWasSealedHoweverItComes) {
  for (const std::size_t size : {0UL, 1UL, 7UL, 4096UL, 65535UL, max_record_bytes})
    for (const std::size_t most : {1UL, 5UL, 1000UL, 1UL << 20}) {
      const RecordBytes plain = noise(size);
      const RecordBytes record = sealed(plain);
      EXPECT_EQ(opened(opener_, record, most), plain) << size << " bytes in pieces of " << most;
    }
}

TEST_F(RecordTest, ShowNothingOfWhatTheyHold) {
  const std::string call = "glDrawArraysInstancedBaseInstance /scans/of_somebody.nrrd";
  RecordBytes plain(call.size());
  std::memcpy(plain.data(), call.data(), call.size());
  const RecordBytes once = sealed(plain);
  const RecordBytes again = sealed(plain);
  const auto text = [](const RecordBytes& bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  for (std::size_t i = 0; i + 4 <= call.size(); ++i)
    EXPECT_EQ(text(once).find(call.substr(i, 4)), std::string::npos) << call.substr(i, 4);
  EXPECT_EQ(text(again).find(text(once).substr(stream_head_bytes + record_length_bytes, 8)), std::string::npos);
}

TEST_F(RecordTest, AChangedByteIsNeverOpened) {
  const RecordBytes line = sealed(noise(40));
  for (std::size_t at = 0; at < line.size(); ++at) {
    RecordBytes changed = line;
    changed[at] ^= std::byte(4);
    RecordOpener opener(keys_.second.receive);
    RecordBytes to(64);
    // A larger length needs more bytes, so more are sent.
    const RecordBytes more(1 << 17);
    changed.insert(changed.end(), more.begin(), more.end());
    EXPECT_THAT(refusal(opener, changed), HasSubstr("changed")) << "byte " << at;
  }
}

TEST_F(RecordTest, AReplayedRecordIsRefused) {
  opened(opener_, sealed(noise(40)));
  const RecordBytes record = sealed(noise(40));
  EXPECT_EQ(refusal(opener_, record), "");
  EXPECT_THAT(refusal(opener_, record), HasSubstr("replayed"));
}

TEST_F(RecordTest, ARecordThatWasLeftOutOrComesTooEarlyIsNoticed) {
  opened(opener_, sealed(noise(40)));
  const RecordBytes first = sealed(noise(40));
  const RecordBytes second = sealed(noise(50));
  EXPECT_THAT(refusal(opener_, second), HasSubstr("left out"));
}

TEST_F(RecordTest, OwnWordsAreNotTakenForThoseOfTheOtherEnd) {
  RecordOpener own(keys_.first.receive);
  EXPECT_THAT(refusal(own, sealed(noise(40))), HasSubstr("does not open"));
}

TEST_F(RecordTest, AnotherSessionOfTheSameSecretOpensNothing) {
  RecordOpener other(keys_of_session(secret_).second.receive);
  EXPECT_THAT(refusal(other, sealed(noise(40))), HasSubstr("does not open"));
}

TEST_F(RecordTest, ALengthThatNoRecordHasIsRefusedBeforeAnyMemoryIsGiven) {
  for (const std::uint32_t length : {0U, 16U, std::uint32_t(max_record_bytes + record_seal_bytes + 1), ~0U}) {
    RecordOpener opener(keys_.second.receive);
    RecordBytes line(stream_head_bytes + record_length_bytes);
    for (std::size_t i = 0; i < record_length_bytes; ++i)
      line[stream_head_bytes + i] = std::byte(length >> 8 * i);
    EXPECT_THAT(refusal(opener, line), HasSubstr("length that none has")) << length;
  }
}

TEST_F(RecordTest, GoOnOverAChangeOfTheKey) {
  for (std::uint32_t i = 0; i < 2 * records_of_a_key + 3; ++i) {
    const RecordBytes plain(1, std::byte(i));
    ASSERT_EQ(opened(opener_, sealed(plain)), plain) << i;
  }
}

}  // namespace
}  // namespace understudy::compositor::testing
