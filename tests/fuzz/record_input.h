// SPDX-License-Identifier: Apache-2.0
// Interprets the bytes of a fuzzer as encrypted data of a session, and as the plain data in it. The key is
// known, so that seeds can be decrypted.
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

/// Decrypts data that arrives in pieces of at most `most` bytes. Throws MalformedMessage.
inline std::vector<std::byte> opened(std::span<const std::byte> line, std::size_t most) {
  compositor::RecordOpener opener(fuzzed_key);
  std::vector<std::byte> all;
  while (!line.empty()) {
    const std::span<std::byte> room = opener.room();
    const std::size_t count = std::min({room.size(), most, line.size()});
    if (count == 0) std::abort();  // the reader accepts no more bytes
    std::ranges::copy(line.first(count), room.begin());
    line = line.subspan(count);
    if (!opener.took(count)) continue;
    const std::size_t before = all.size();
    all.resize(before + opener.plain_bytes());
    opener.open(std::span(all).subspan(before));
  }
  return all;
}

/// Input as received data. Returns whether all of it was decrypted.
inline bool open_records(std::span<const std::byte> input) {
  try {
    opened(input, input.empty() ? 1 : 1 + std::to_integer<std::size_t>(input.front()));
  } catch (const compositor::MalformedMessage&) {
    return false;
  }
  return true;
}

/// Input as sent data, in records whose lengths the input determines: decryption must restore it.
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
