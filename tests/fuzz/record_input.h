// SPDX-License-Identifier: Apache-2.0
// How the bytes of a fuzzer come as the line of an encrypted session, and as what was sealed in it. The key is
// known, so that seeds are opened.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <vector>

#include "compositor/transport/tcp/record_opener.h"
#include "compositor/transport/tcp/record_sealer.h"
#include "compositor/transport/wire.h"

namespace understudy::spu::testing {

inline constexpr std::array<unsigned char, compositor::session_key_bytes> fuzzed_key{1, 2, 3};

/// What is opened of a line that comes in pieces of at most `most` bytes. Throws MalformedMessage.
inline std::vector<std::byte> opened(std::span<const std::byte> line, std::size_t most) {
  compositor::RecordOpener opener(fuzzed_key);
  std::vector<std::byte> all;
  while (!line.empty()) {
    const std::span<std::byte> room = opener.room();
    const std::size_t count = std::min({room.size(), most, line.size()});
    if (count == 0) std::abort();  // a line that never goes on
    std::ranges::copy(line.first(count), room.begin());
    line = line.subspan(count);
    if (!opener.took(count)) continue;
    const std::size_t before = all.size();
    all.resize(before + opener.plain_bytes());
    opener.open(std::span(all).subspan(before));
  }
  return all;
}

/// As a line that somebody sends. Whether all of it was opened.
inline bool open_records(std::span<const std::byte> input) {
  try {
    opened(input, input.empty() ? 1 : 1 + std::to_integer<std::size_t>(input.front()));
  } catch (const compositor::MalformedMessage&) {
    return false;
  }
  return true;
}

/// As what an end sends, in records whose lengths the input says: all of it must come back.
inline void seal_and_open(std::span<const std::byte> input) {
  compositor::RecordSealer sealer(fuzzed_key);
  std::vector<std::byte> line;
  for (std::span<const std::byte> left = input; !left.empty();) {
    const std::size_t count = std::min(left.size(), 251 * std::to_integer<std::size_t>(left.front()) + 1);
    const auto record = sealer.seal(left.first(count));
    line.insert(line.end(), record.begin(), record.end());
    left = left.subspan(count);
  }
  if (!std::ranges::equal(opened(line, 4099), input)) std::abort();
}

}  // namespace understudy::spu::testing
