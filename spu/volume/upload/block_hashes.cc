// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/upload/block_hashes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace understudy::spu {
namespace {

using volume::TexelBox;

__extension__ using Product = unsigned __int128;

// Arbitrary odd numbers with about as many ones as zeros.
constexpr std::uint64_t first_key = 0x9e3779b97f4a7c15, second_key = 0xd1b54a32d192ed03;

/// Not 0: otherwise a row that ends in zeros would make the product 0 whatever it begins with.
constexpr std::uint64_t first_hash = second_key;

/// Folds the whole product: every bit of either factor affects every bit of the result.
std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  const Product product = Product(a) * b;
  return std::uint64_t(product) ^ std::uint64_t(product >> 64);
}

std::uint64_t hash_of(std::uint64_t hash, const std::byte* bytes, std::size_t count) {
  std::array<std::uint64_t, 2> words;
  for (; count >= sizeof words; bytes += sizeof words, count -= sizeof words) {
    std::memcpy(words.data(), bytes, sizeof words);
    hash = mixed(words[0] ^ first_key, words[1] ^ hash) + second_key;
  }
  if (count > 0) {
    words = {};
    std::memcpy(words.data(), bytes, count);
    hash = mixed(words[0] ^ first_key, words[1] ^ hash) + second_key;
  }
  return hash;
}

void widen_by_floats(std::array<float, 2>& range, const std::byte* texels, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    float value;
    std::memcpy(&value, texels + i * sizeof value, sizeof value);
    if (!std::isfinite(value)) continue;
    range[0] = std::min(range[0], value);
    range[1] = std::max(range[1], value);
  }
}

void widen_by_words(std::array<float, 2>& range, const std::byte* texels, std::size_t count) {
  std::uint16_t low = 65535;
  std::uint16_t high = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t value;
    std::memcpy(&value, texels + i * sizeof value, sizeof value);
    low = std::min(low, value);
    high = std::max(high, value);
  }
  range[0] = std::min(range[0], float(low) / 65535.0F);
  range[1] = std::max(range[1], float(high) / 65535.0F);
}

/// Adds a box, or extends one that ends along `axis` where it begins.
void add(std::vector<TexelBox>& boxes, const TexelBox& box, std::size_t axis) {
  for (TexelBox& other : boxes) {
    // Moved along the axis to where `box` lies, it must be the same box.
    TexelBox moved = other;
    moved.low[axis] = box.low[axis];
    moved.high[axis] = box.high[axis];
    if (other.high[axis] != box.low[axis] || moved != box) continue;
    other.high[axis] = box.high[axis];
    return;
  }
  boxes.push_back(box);
}

constexpr std::array<float, 2> no_values{std::numeric_limits<float>::max(),
                                         std::numeric_limits<float>::lowest()};

}  // namespace

BlockHashes::BlockHashes(const TexelBox& stored, volume::TexelType type) : stored_(stored), type_(type) {
  for (std::size_t k = 0; k < 3; ++k)
    counts_[k] = std::size_t(stored.high[k] - stored.low[k] + edge - 1) / edge;
  blocks_.resize(counts_[0] * counts_[1] * counts_[2], Block{0, no_values});
  known_.resize(blocks_.size());
  arriving_.resize(counts_[0] * counts_[1]);
}

TexelBox BlockHashes::whole_blocks(const TexelBox& box) const {
  TexelBox whole = volume::intersection(box, stored_);
  if (volume::is_empty(whole)) return {};
  for (std::size_t k = 0; k < 3; ++k) {
    const int low = (whole.low[k] - stored_.low[k]) / edge,
              high = (whole.high[k] - stored_.low[k] + edge - 1) / edge;
    whole.low[k] = stored_.low[k] + low * edge;
    whole.high[k] = std::min(stored_.low[k] + high * edge, stored_.high[k]);
  }
  return whole;
}

std::vector<TexelBox> BlockHashes::take(const TexelBox& box, std::span<const std::byte> texels) {
  std::vector<TexelBox> changed;
  const std::size_t slice = texels.size() / std::size_t(box.high[2] - box.low[2]);
  for (int z = box.low[2]; z < box.high[2]; ++z) {
    take_slice(z, box, texels.data() + std::size_t(z - box.low[2]) * slice);
    if ((z + 1 - stored_.low[2]) % edge == 0 || z + 1 == stored_.high[2]) compare_layer(z, box, changed);
  }
  return changed;
}

void BlockHashes::take_slice(int z, const TexelBox& box, const std::byte* slice) {
  const std::size_t texel = volume::bytes_per_texel(type_);
  const bool first_of_block = (z - stored_.low[2]) % edge == 0;
  for (int y = box.low[1]; y < box.high[1]; ++y) {
    const bool first_row = first_of_block && (y - stored_.low[1]) % edge == 0;
    Block* block = arriving_.data() + std::size_t(y - stored_.low[1]) / edge * counts_[0] +
                   std::size_t(box.low[0] - stored_.low[0]) / edge;
    for (int x = box.low[0]; x < box.high[0]; x += edge, ++block) {
      const auto width = std::size_t(std::min(edge, box.high[0] - x));
      if (first_row) *block = {first_hash, no_values};
      block->hash = hash_of(block->hash, slice, width * texel);
      if (type_ == volume::TexelType::f32) widen_by_floats(block->range, slice, width);
      if (type_ == volume::TexelType::u16) widen_by_words(block->range, slice, width);
      slice += width * texel;
    }
  }
}

void BlockHashes::compare_layer(int z, const TexelBox& box, std::vector<TexelBox>& changed) {
  const auto layer = std::size_t(z - stored_.low[2]) / edge;
  std::vector<TexelBox> here;
  TexelBox run;
  run.low[2] = stored_.low[2] + int(layer) * edge;
  run.high[2] = z + 1;
  for (int y = box.low[1]; y < box.high[1]; y += edge) {
    run.low[1] = y;
    run.high[1] = std::min(y + edge, box.high[1]);
    bool open = false;
    for (int x = box.low[0]; x < box.high[0]; x += edge) {
      const std::size_t column =
          std::size_t(y - stored_.low[1]) / edge * counts_[0] + std::size_t(x - stored_.low[0]) / edge;
      const std::size_t index = layer * arriving_.size() + column;
      const bool same = known_[index] && blocks_[index].hash == arriving_[column].hash;
      blocks_[index] = arriving_[column];
      known_[index] = true;
      if (!same && !open) run.low[0] = x;
      if (same && open) add(here, run, 1);
      open = !same;
      run.high[0] = std::min(x + edge, box.high[0]);
    }
    if (open) add(here, run, 1);
  }
  for (const TexelBox& each : here) add(changed, each, 2);
}

std::array<float, 2> BlockHashes::range() const {
  std::array<float, 2> range = no_values;
  for (const Block& block : blocks_) {
    range[0] = std::min(range[0], block.range[0]);
    range[1] = std::max(range[1], block.range[1]);
  }
  return range;
}

}  // namespace understudy::spu
