// Inputs that fuzzers have found worth keeping, and many that are nearly these.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/fuzz/link_input.h"

namespace understudy::spu::testing {
namespace {

using Buffer = std::vector<std::byte>;

std::vector<Buffer> corpus(const std::filesystem::path& folder) {
  std::vector<Buffer> inputs;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    inputs.emplace_back(reinterpret_cast<const std::byte*>(bytes.data()),
                        reinterpret_cast<const std::byte*>(bytes.data()) + bytes.size());
  }
  return inputs;
}

/// Some bytes are others, and the end may be missing.
Buffer nearly(Buffer input, std::mt19937& random) {
  if (input.empty()) return input;
  for (unsigned count = random() % 6; count > 0; --count) input[random() % input.size()] = std::byte(random());
  if (random() % 3 == 0) input.resize(random() % input.size());
  return input;
}

template <class Play>
void play_all(const std::filesystem::path& folder, Play play) {
  const std::vector<Buffer> inputs = corpus(folder);
  ASSERT_GT(inputs.size(), 4U) << folder;
  std::mt19937 random(11);
  for (const Buffer& input : inputs) {
    play(input);
    for (int i = 0; i < 200; ++i) play(nearly(input, random));
  }
}

TEST(LinkCorpus, NothingThatNobodySentDoesHarm) {
  play_all(LINK_CORPUS, [](const Buffer& input) { play_link_input(input); });
}

TEST(StageCorpus, NothingThatNobodyWouldSayDoesHarm) {
  play_all(STAGE_CORPUS, [](const Buffer& input) { play_stage_input(input); });
}

}  // namespace
}  // namespace understudy::spu::testing
