// SPDX-License-Identifier: Apache-2.0
// Detects which blocks differ from what was sent.
#include "spu/volume/upload/block_hashes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::spu {
namespace {

using volume::TexelBox;
using volume::TexelType;

std::vector<std::byte> part(const TexelBox& stored, const std::vector<std::byte>& texels, const TexelBox& box) {
  std::vector<std::byte> cut(volume::texels_in(box));
  volume::copy_texels(box, 1, stored, texels, box, cut);
  return cut;
}

const TexelBox stored{{3, 0, 5}, {3 + 50, 37, 5 + 40}};

std::vector<std::byte> noise(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::byte> texels(volume::texels_in(stored));
  for (std::byte& texel : texels) texel = std::byte(random());
  return texels;
}

std::size_t at(int x, int y, int z) {
  return std::size_t(((z - stored.low[2]) * 37 + y) * 50 + x - stored.low[0]);
}

TEST(BlockHashes, AllTexelsAreNewAtFirstAndNoneAfterwards) {
  BlockHashes hashes(stored, TexelType::u8);
  const auto texels = noise(1);
  const auto first = hashes.take(stored, texels);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first.front(), stored) << "neighbouring blocks are one box";
  EXPECT_TRUE(hashes.take(stored, texels).empty());
}

TEST(BlockHashes, OneTexelIsOneBlock) {
  BlockHashes hashes(stored, TexelType::u8);
  auto texels = noise(2);
  hashes.take(stored, texels);
  for (const auto& [x, y, z] : {std::array{3, 0, 5}, {18, 15, 20}, {19, 16, 21}, {52, 36, 44}}) {
    texels[at(x, y, z)] ^= std::byte(0x80);
    const auto changed = hashes.take(stored, texels);
    ASSERT_EQ(changed.size(), 1U);
    EXPECT_EQ(changed.front(), hashes.whole_blocks({{x, y, z}, {x + 1, y + 1, z + 1}}));
    EXPECT_LE(volume::texels_in(changed.front()), 4096U);
  }
}

TEST(BlockHashes, EveryBitAndEveryPlaceCounts) {
  BlockHashes hashes({{0, 0, 0}, {16, 16, 16}}, TexelType::u8);
  const TexelBox block{{0, 0, 0}, {16, 16, 16}};
  std::vector<std::byte> texels(4096);
  hashes.take(block, texels);
  for (std::size_t i = 0; i < texels.size(); i += 5)
    for (int bit = 0; bit < 8; ++bit) {
      // Two equal bits, whose hashes must not cancel.
      texels[i] ^= std::byte(1 << bit);
      EXPECT_EQ(hashes.take(block, texels).size(), 1U);
      texels[(i + 1024) % 4096] ^= std::byte(1 << bit);
      EXPECT_EQ(hashes.take(block, texels).size(), 1U);
      std::swap(texels[i], texels[(i + 3) % 4096]);
      EXPECT_EQ(hashes.take(block, texels).size(), texels[i] != texels[(i + 3) % 4096] ? 1U : 0U);
    }
}

TEST(BlockHashes, RandomChangesAreCoveredExactly) {
  const unsigned seed = 77;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  BlockHashes hashes(stored, TexelType::u8);
  auto texels = noise(3);
  hashes.take(stored, texels);
  for (int round = 0; round < 60; ++round) {
    std::vector<bool> expected(4 * 3 * 3);
    for (unsigned i = 0; i < 1 + random() % 6; ++i) {
      const int x = 3 + int(random() % 50), y = int(random() % 37), z = 5 + int(random() % 40);
      texels[at(x, y, z)] ^= std::byte(1 + random() % 255);
      expected[(z - 5) / 16 * 12 + y / 16 * 4 + (x - 3) / 16] = true;
    }
    // In slice ranges of any thickness, as in a first upload, or of whole blocks.
    std::vector<TexelBox> changed;
    for (TexelBox slice_segment = stored; slice_segment.low[2] < stored.high[2];
         slice_segment.low[2] = slice_segment.high[2]) {
      slice_segment.high[2] =
          std::min(stored.high[2], slice_segment.low[2] + (round % 2 == 0 ? 16 : 1 + int(random() % 9)));
      const auto more = hashes.take(slice_segment, part(stored, texels, slice_segment));
      changed.insert(changed.end(), more.begin(), more.end());
    }
    std::vector<int> covered(expected.size());
    for (const TexelBox& box : changed)
      for (int z = box.low[2]; z < box.high[2]; z += 16)
        for (int y = box.low[1]; y < box.high[1]; y += 16)
          for (int x = box.low[0]; x < box.high[0]; x += 16)
            ++covered[(z - 5) / 16 * 12 + y / 16 * 4 + (x - 3) / 16];
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_EQ(covered[i], expected[i] ? 1 : 0) << "block " << i;
  }
}

TEST(BlockHashes, PartsAreComparedAlone) {
  BlockHashes hashes(stored, TexelType::u8);
  auto texels = noise(4);
  hashes.take(stored, texels);
  for (std::byte& texel : texels) texel ^= std::byte(1);
  const TexelBox some = hashes.whole_blocks({{20, 17, 22}, {22, 18, 23}});
  EXPECT_EQ(some, (TexelBox{{19, 16, 21}, {35, 32, 37}}));
  EXPECT_EQ(hashes.take(some, part(stored, texels, some)), std::vector<TexelBox>{some});
  EXPECT_TRUE(hashes.take(some, part(stored, texels, some)).empty());
  EXPECT_FALSE(hashes.take(stored, texels).empty()) << "the rest was not looked at";
  EXPECT_TRUE(volume::is_empty(hashes.whole_blocks({{60, 0, 0}, {70, 4, 4}})));
}

TEST(BlockHashes, KnowTheRangeOfFiniteValues) {
  const TexelBox box{{0, 0, 0}, {20, 20, 20}};
  BlockHashes hashes(box, TexelType::f32);
  EXPECT_GT(hashes.range()[0], hashes.range()[1]);
  std::vector<float> values(8000, 2.0F);
  const auto take = [&] { hashes.take(box, std::as_bytes(std::span(values))); };
  values[17] = -3;
  values[18] = std::nanf("");
  values[7999] = 9;
  values[7998] = INFINITY;
  take();
  EXPECT_EQ(hashes.range(), (std::array{-3.0F, 9.0F}));
  values[17] = 1;
  take();
  EXPECT_EQ(hashes.range(), (std::array{1.0F, 9.0F})) << "what is gone counts no longer";
}

TEST(BlockHashes, KnowTheRangeOf16BitValues) {
  const TexelBox box{{0, 0, 0}, {20, 20, 20}};
  BlockHashes hashes(box, TexelType::u16);
  std::vector<std::uint16_t> values(8000, 500);
  values[17] = 7;
  values[7999] = 1300;
  hashes.take(box, std::as_bytes(std::span(values)));
  EXPECT_EQ(hashes.range(), (std::array{7.0F / 65535, 1300.0F / 65535}));
}

}  // namespace
}  // namespace understudy::spu
