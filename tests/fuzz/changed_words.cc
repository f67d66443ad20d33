// SPDX-License-Identifier: Apache-2.0
// Custom mutator of the stream fuzzers: mutates by words, since a stream consists of words, and by bytes as
// usual.
#include <array>
#include <cstdint>
#include <cstring>
#include <random>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr std::array<std::uint64_t, 20> extremes = {
    0, 1, 2, 3, 4, 16, 255, 4096, 65536, 0x7fff'ffff, 0x8000'0000, 0xffff'ffff, std::uint64_t(1) << 40,
    ~std::uint64_t(0), std::uint64_t(1) << 63,
    // References of every kind to data that may exist.
    std::uint64_t(1) << 56 | 4, std::uint64_t(2) << 56, std::uint64_t(3) << 56 | 8, std::uint64_t(4) << 56 | 8,
    std::uint64_t(5) << 56 | 4};

std::uint64_t changed(std::uint64_t word, std::mt19937& random) {
  switch (random() % 4) {
    case 0:
      return extremes[random() % extremes.size()];
    case 1:
      return word ^ std::uint64_t(1) << random() % 64;
    case 2:
      return word + random() % 17 - 8;
    default:
      return (word & 0xff00'0000'0000'0000U) | random() % 64;
  }
}

void move_word(std::uint8_t* data, std::size_t from, std::size_t to, std::mt19937& random, bool change) {
  std::uint64_t word = 0;
  std::memcpy(&word, data + from * 8, 8);
  if (change) word = changed(word, random);
  std::memcpy(data + to * 8, &word, 8);
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t words = size / 8;
  if (words < 2 || random() % 4 == 0) return LLVMFuzzerMutate(data, size, most);
  for (unsigned count = 1 + random() % 3; count > 0; --count) {
    const std::size_t at = random() % words;
    move_word(data, random() % 8 == 0 ? random() % words : at, at, random, true);
  }
  return size;
}
