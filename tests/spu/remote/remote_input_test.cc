// SPDX-License-Identifier: Apache-2.0
// Plays the seeds of the fuzzers, and many inputs close to them.
#include "tests/fuzz/remote_input.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/fuzz/record_input.h"
#include "tests/fuzz/remote_seeds.h"

namespace understudy::spu::testing {
namespace {

using Buffer = std::vector<std::byte>;

/// `input` with some bytes changed, and sometimes truncated.
Buffer nearly(Buffer input, std::mt19937& random) {
  if (input.empty()) return input;
  for (unsigned count = random() % 6; count > 0; --count) input[random() % input.size()] = std::byte(random());
  if (random() % 3 == 0) input.resize(random() % input.size());
  return input;
}

template <class Play>
void play_all(const Seeds& seeds, Play play) {
  std::mt19937 random(11);
  for (const auto& [name, seed] : seeds) {
    play(name, seed);
    for (int i = 0; i < 200; ++i) play("", nearly(seed, random));
  }
}

TEST(RemoteInput, NothingThatNobodySentDoesHarm) {
  play_all(remote_seeds(), [](const std::string& name, const Buffer& input) {
    const int believed = play_remote_input(input);
    const bool is_handshake = name.empty() || name == "client" || name == "server";
    EXPECT_TRUE(is_handshake || believed == 1) << name;
  });
}

TEST(RecordInput, NothingThatNobodySealedDoesHarm) {
  play_all(record_seeds(), [](const std::string& name, const Buffer& input) {
    const bool believed = open_records(input);
    EXPECT_TRUE(name.empty() || believed) << name;
    seal_and_open(input);
  });
}

TEST(GlServerInput, NothingThatNobodyWouldSayDoesHarm) {
  play_all(gl_server_seeds(), [](const std::string& name, const Buffer& input) {
    const int believed = play_gl_server_input(input);
    EXPECT_TRUE(name.empty() || believed == (name == "calls" ? 2 : 1)) << name;
  });
}

}  // namespace
}  // namespace understudy::spu::testing
