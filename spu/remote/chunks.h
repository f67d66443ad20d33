// SPDX-License-Identifier: Apache-2.0
// What an application does frame after frame is mostly the same: words that were sent before are named, not
// sent again. Both ends keep the last chunks that travelled, in slots that the sender chooses, so that they
// always agree without a word.
//
// In a message stand the number of chunks, a word for each -- slot (low 16 bits), whether the receiver has it
// (bit 16), number of words (high 32 bits) -- and then the words of those that it has not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace understudy::spu {

constexpr std::size_t max_chunk_words = 1024;  ///< 8 KiB
constexpr std::size_t chunk_slots = 8192;      ///< so that an end keeps 64 MiB at most

class ChunkSender {
 public:
  /// Cuts `records`, between records where they allow it, and then `payload`.
  void add(std::span<const std::uint64_t> records, std::span<const std::uint64_t> payload);
  /// What was added since the last clear().
  std::span<const std::uint64_t> heads() const { return heads_; }
  std::span<const std::uint64_t> data() const { return data_; }
  void clear();

 private:
  struct Slot {
    std::uint64_t hash = 0;
    std::vector<std::uint64_t> words;
  };

  void add_chunk(std::span<const std::uint64_t> words);

  std::vector<Slot> slots_;  ///< as many as were used
  std::unordered_map<std::uint64_t, std::size_t> by_hash_;
  std::size_t next_slot_ = 0;
  std::vector<std::uint64_t> heads_;
  std::vector<std::uint64_t> data_;
};

class ChunkReceiver {
 public:
  /// The words that were added, one after the other, valid until the next call. `message` is heads and data.
  /// Throws compositor::MalformedMessage, also where there would be more than `most` words.
  std::span<const std::uint64_t> receive(std::span<const std::uint64_t> message, std::uint64_t most);

 private:
  std::vector<std::vector<std::uint64_t>> slots_;  ///< up to the highest that was used
  std::vector<std::uint64_t> words_;
};

}  // namespace understudy::spu
