// SPDX-License-Identifier: Apache-2.0
// Plays the bytes of a fuzzer, or a file of its corpus: as a trace file and as bare records, and both as
// recorded streams and as streams that wait for answers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "spu/stream/decode.h"
#include "spu/stream/trace_file.h"

namespace understudy::spu::testing {

inline void play_records(std::span<const std::uint64_t> words, std::span<const std::uint64_t> payload,
                         StreamOrigin origin, const DispatchTable& gl) {
  Decoder decoder(origin, std::make_shared<ObjectNames>());
  for (std::size_t at = 0; at < words.size();) {
    const auto record = record_at(words, at, payload);
    if (!record) break;
    decoder.decode(*record, gl);
    at += record->words.size();
  }
}

/// Calls `take(records, payload)` for the input parsed as a trace, and for the input as bare records.
template <class Take>
void walk_input(std::span<const std::byte> input, Take take) {
  try {
    TraceReader reader(input);
    while (const auto block = reader.next()) take(block->records, block->payload);
  } catch (const std::runtime_error&) {
    // Not a trace.
  }
  // A separate copy of each part, so that sanitizers detect accesses outside.
  std::vector<std::uint64_t> words(input.size() / 8);
  if (words.empty()) return;
  std::memcpy(words.data(), input.data(), words.size() * 8);
  // The first word gives the number of record words; the payload follows them.
  const std::size_t count = std::min<std::size_t>(words[0] & 0xffff, words.size() - 1);
  const auto end_of_records = words.begin() + 1 + std::ptrdiff_t(count);
  const std::vector<std::uint64_t> records(words.begin() + 1, end_of_records);
  const std::vector<std::uint64_t> payload(end_of_records, words.end());
  take(std::span(records), std::span(payload));
}

/// Plays each part, from each origin, above a new `Driver`, since a driver may retain memory of its decoder.
template <class Driver>
void play_input(std::span<const std::byte> input) {
  walk_input(input, [&](auto records, auto payload) {
    for (const StreamOrigin origin : {StreamOrigin::elsewhere, StreamOrigin::linked}) {
      const Driver driver;
      play_records(records, payload, origin, driver.table());
    }
  });
}

}  // namespace understudy::spu::testing
