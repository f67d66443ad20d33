// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/chunks.h"

#include <algorithm>
#include <bit>

#include "compositor/transport/wire.h"

namespace understudy::spu {

using compositor::MalformedMessage;

namespace {

/// A chunk of records ends with the first record that makes it at least this long.
constexpr std::size_t usual_chunk_words = 256;
constexpr std::uint64_t known_bit = std::uint64_t(1) << 16;

std::uint64_t hash_of(std::span<const std::uint64_t> words) {
  std::uint64_t hash = words.size();
  for (const std::uint64_t word : words) hash = std::rotl((hash ^ word) * 0x9e3779b97f4a7c15U, 29);
  return hash;
}

bool same(std::span<const std::uint64_t> a, std::span<const std::uint64_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

}  // namespace

void ChunkSender::clear() {
  heads_.clear();
  data_.clear();
}

void ChunkSender::add_chunk(std::span<const std::uint64_t> words) {
  const std::uint64_t hash = hash_of(words);
  const auto found = by_hash_.find(hash);
  if (found != by_hash_.end() && same(slots_[found->second].words, words)) {
    heads_.push_back(found->second | known_bit | std::uint64_t(words.size()) << 32);
    return;
  }
  // The oldest chunk is replaced, however often it was referred to since.
  const std::size_t at = next_slot_;
  // This comes first because it may throw: the next slot must never be beyond the end.
  if (at == slots_.size()) slots_.emplace_back();
  next_slot_ = (next_slot_ + 1) % chunk_slots;
  Slot& slot = slots_[at];
  if (const auto gone = by_hash_.find(slot.hash); gone != by_hash_.end() && gone->second == at)
    by_hash_.erase(gone);
  slot.hash = hash;
  slot.words.assign(words.begin(), words.end());
  by_hash_[hash] = at;
  heads_.push_back(at | std::uint64_t(words.size()) << 32);
  data_.insert(data_.end(), words.begin(), words.end());
}

void ChunkSender::add(std::span<const std::uint64_t> records, std::span<const std::uint64_t> payload) {
  std::size_t first = 0;
  std::size_t end = 0;
  const auto cut = [&](std::span<const std::uint64_t> words) {
    for (; first < end; first += std::min(max_chunk_words, end - first))
      add_chunk(words.subspan(first, std::min(max_chunk_words, end - first)));
  };
  while (end < records.size()) {
    // The length in a record is not checked here; it only determines where to cut.
    const std::uint64_t length = std::max<std::uint64_t>(records[end] >> 32, 1);
    if (end > first && end - first + length > max_chunk_words) cut(records);
    end += std::size_t(std::min<std::uint64_t>(length, records.size() - end));
    if (end - first >= usual_chunk_words) cut(records);
  }
  cut(records);
  first = 0;
  end = payload.size();
  cut(payload);
}

std::span<const std::uint64_t> ChunkReceiver::receive(std::span<const std::uint64_t> message,
                                                      std::uint64_t most) {
  words_.clear();
  if (message.empty() || message[0] > message.size() - 1)
    throw MalformedMessage("calls: fewer chunks than announced");
  const auto heads = message.subspan(1, message[0]);
  auto data = message.subspan(1 + message[0]);
  for (const std::uint64_t head : heads) {
    const std::size_t slot = head & 0xffff;
    const std::size_t count = head >> 32;
    if (slot >= chunk_slots || count == 0 || count > max_chunk_words || count > most - words_.size())
      throw MalformedMessage("calls: a chunk of no size, or of no place");
    if (slot >= slots_.size()) slots_.resize(slot + 1);
    std::vector<std::uint64_t>& kept = slots_[slot];
    if ((head & known_bit) == 0) {
      if (count > data.size()) throw MalformedMessage("calls: a chunk is missing");
      kept.assign(data.begin(), data.begin() + std::ptrdiff_t(count));
      data = data.subspan(count);
    } else if (kept.size() != count) {
      throw MalformedMessage("calls: a chunk that was never sent");
    }
    words_.insert(words_.end(), kept.begin(), kept.end());
  }
  if (!data.empty()) throw MalformedMessage("calls: words that belong to no chunk");
  return words_;
}

}  // namespace understudy::spu
