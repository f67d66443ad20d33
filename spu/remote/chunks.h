// SPDX-License-Identifier: Apache-2.0
// An application repeats most of its calls in every frame: words that were sent before are referred to, not
// sent again. Both ends keep the last chunks that were sent, in slots chosen by the sender, so they always
// agree without extra messages.
//
// A message contains the number of chunks, one word per chunk -- slot (low 16 bits), whether the receiver has
// the chunk (bit 16), number of words (high 32 bits) -- and then the words of the chunks that it lacks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace understudy::spu {

constexpr std::size_t max_chunk_words = 1024;  ///< 8 KiB
constexpr std::size_t chunk_slots = 8192;      ///< limits the memory of an end to 64 MiB

class ChunkSender {
 public:
  /// Cuts `records`, between records where their length allows it, and then `payload`, into chunks.
  void add(std::span<const std::uint64_t> records, std::span<const std::uint64_t> payload);
  /// The chunks that were added since the last clear().
  std::span<const std::uint64_t> heads() const { return heads_; }
  std::span<const std::uint64_t> data() const { return data_; }
  void clear();

 private:
  struct Slot {
    std::uint64_t hash = 0;
    std::vector<std::uint64_t> words;
  };

  void add_chunk(std::span<const std::uint64_t> words);

  std::vector<Slot> slots_;  ///< only the slots that were used
  std::unordered_map<std::uint64_t, std::size_t> by_hash_;
  std::size_t next_slot_ = 0;
  std::vector<std::uint64_t> heads_;
  std::vector<std::uint64_t> data_;
};

class ChunkReceiver {
 public:
  /// Returns the words in the order in which they were added, valid until the next call. `message` is heads and
  /// data. Throws compositor::MalformedMessage, also if there would be more than `most` words.
  std::span<const std::uint64_t> receive(std::span<const std::uint64_t> message, std::uint64_t most);

 private:
  std::vector<std::vector<std::uint64_t>> slots_;  ///< up to the highest slot that was used
  std::vector<std::uint64_t> words_;
};

}  // namespace understudy::spu
