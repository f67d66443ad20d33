// SPDX-License-Identifier: Apache-2.0
// A record: one OpenGL call, or one event of the stream, as 8-byte words.
//
//     word 0        stable id of the call (low half), number of words of the record with this one (high half)
//     words 1..n    one per argument: the value, or for pointers a reference (below)
//     then          data that references within the record refer to
//
// Stable ids are hashed from names (dispatch/call_shape.h), not assigned by position. Large data is stored
// separately, in the payload of the block, so that a reader can walk through the records without touching it.
// This is Chromium's packer (Humphreys et al. 2002, section 4), but with names instead of op-codes, and with
// checked lengths.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace understudy::spu {

/// The word of a pointer argument: the kind in its highest byte, a value below.
enum class ReferenceKind : std::uint8_t {
  null,     ///< a null pointer
  inside,   ///< value: position in the record of {bytes, data}, in words
  payload,  ///< value: position in the block's payload of {bytes, data}, in words
  address,  ///< value: an offset into a buffer object, or an address that is valid only for the sender
  output,   ///< value: where the sender's process stores the answer
  strings,  ///< as inside; data: for every string its length as a word, bytes, a zero, padding to a full word
  lists,    ///< as inside; data: for every list {bytes, data}, each padded to a full word
};

struct Reference {
  ReferenceKind kind = ReferenceKind::null;
  std::uint64_t value = 0;

  /// Addresses keep their low 56 bits, sign-extended, which covers all of user space and all buffer offsets.
  constexpr std::uint64_t word() const { return std::uint64_t(kind) << 56 | (value & 0x00ff'ffff'ffff'ffffU); }
  static constexpr Reference from(std::uint64_t word) {
    const auto value = std::uint64_t(std::int64_t(word << 8) >> 8);
    return {ReferenceKind(word >> 56), value};
  }
};

/// FNV-1a hash of a name: the id of a call or event.
constexpr std::uint32_t stable_id_of(std::string_view name) {
  std::uint32_t id = 0x811c9dc5U;
  for (const char c : name) id = (id ^ std::uint8_t(c)) * 0x01000193U;
  return id;
}

constexpr std::size_t words_for(std::size_t bytes) {
  return (bytes + 7) / 8;
}

/// Data of at least this many bytes goes to the payload.
constexpr std::size_t payload_threshold = 1024;

/// Words that grow at the end like a vector, but are not zeroed before they are written.
class Words {
 public:
  Words() = default;
  Words(Words&& other) noexcept { *this = std::move(other); }
  Words& operator=(Words&& other) noexcept {
    memory_ = std::move(other.memory_);
    room_ = std::exchange(other.room_, 0);
    size_ = std::exchange(other.size_, 0);
    return *this;
  }
  /// Adds `count` uninitialised words; the pointer is valid until more are added.
  std::uint64_t* extend(std::size_t count) {
    if (room_ - size_ < count) grow(std::max(2 * room_, size_ + count));
    std::uint64_t* const added = memory_.get() + size_;
    size_ += count;
    return added;
  }
  /// Adds {bytes, data}, padded with zeros to a full word.
  void append_data(std::span<const std::byte> bytes) {
    *extend(1) = bytes.size();
    append_bytes(bytes, words_for(bytes.size()));
  }
  void append_bytes(std::span<const std::byte> bytes, std::size_t words) {
    if (words == 0) return;
    std::uint64_t* const added = extend(words);
    added[words - 1] = 0;
    if (!bytes.empty()) std::memcpy(added, bytes.data(), bytes.size());
  }
  void insert(std::size_t position, const Words& other) {
    extend(other.size_);
    std::copy_backward(data() + position, data() + size_ - other.size_, data() + size_);
    std::copy_n(other.memory_.get(), other.size_, data() + position);
  }
  std::uint64_t* data() { return memory_.get(); }
  std::size_t size() const { return size_; }
  std::span<const std::uint64_t> words() const { return {memory_.get(), size_}; }
  void clear() { size_ = 0; }
  /// Removes everything after the first `size` words.
  void rewind(std::size_t size) { size_ = size; }

 private:
  void grow(std::size_t room) {
    auto memory = std::make_unique_for_overwrite<std::uint64_t[]>(room);
    std::copy_n(memory_.get(), size_, memory.get());
    memory_ = std::move(memory);
    room_ = room;
  }

  std::unique_ptr<std::uint64_t[]> memory_;
  std::size_t room_ = 0;
  std::size_t size_ = 0;
};

/// Records in the order of their calls, and their payload. Growing again after `clear` allocates no memory.
class Records {
 public:
  Records() = default;
  /// Without a payload, all data stays in the records, so that they can be moved.
  static Records without_payload() {
    Records records;
    records.threshold_ = ~std::size_t(0);
    return records;
  }

  /// Starts a record; the following words belong to it until the next one starts.
  void begin(std::uint32_t id) { append_record(id, 1); }
  void append(std::uint64_t word) {
    *words_.extend(1) = word;
    close();
  }
  /// A record whose arguments are all values.
  void append_plain(std::uint32_t id, std::span<const std::uint64_t> arguments) {
    std::uint64_t* const record = append_record(id, arguments.size() + 1);
    // A loop, because the arguments were just written one by one, and a wide load would wait for these stores.
    for (std::size_t i = 0; i < arguments.size(); ++i) record[i + 1] = arguments[i];
  }
  /// Adds a record of `words` words, all of which except the header must be set before the next one starts.
  std::uint64_t* append_record(std::uint32_t id, std::size_t words) {
    start_ = words_.size();
    std::uint64_t* const record = words_.extend(words);
    record[0] = id | std::uint64_t(words) << 32;
    return record;
  }
  /// Reserves `count` words, to be set later by their position within the record.
  void reserve(std::size_t count) {
    std::fill_n(words_.extend(count), count, 0);
    close();
  }
  void set(std::size_t word_of_record, std::uint64_t value) { words_.data()[start_ + word_of_record] = value; }

  /// Copies `bytes` into the record or, if there are many, into the payload.
  Reference attach(std::span<const std::byte> bytes) {
    if (bytes.size() >= threshold_) {
      const Reference reference{ReferenceKind::payload, payload_.size()};
      payload_.append_data(bytes);
      return reference;
    }
    const Reference reference{ReferenceKind::inside, words_.size() - start_};
    words_.append_data(bytes);
    close();
    return reference;
  }
  /// Starts data of kind strings or lists, whose words the caller appends.
  Reference begin_inside(ReferenceKind kind) {
    const Reference reference{kind, words_.size() - start_};
    append(0);
    return reference;
  }
  void end_inside(Reference reference) {
    set(reference.value, (words_.size() - start_ - reference.value - 1) * 8);
  }
  void append_bytes(std::span<const std::byte> bytes, bool terminated) {
    words_.append_bytes(bytes, words_for(bytes.size() + (terminated ? 1 : 0)));
    close();
  }

  /// Inserts records without payload before the record at word `position`.
  void insert(std::size_t position, const Records& other) {
    words_.insert(position, other.words_);
    start_ += other.words_.size();
  }

  std::span<const std::uint64_t> words() const { return words_.words(); }
  std::span<const std::uint64_t> payload() const { return payload_.words(); }
  bool empty() const { return words_.size() == 0; }
  void clear() {
    words_.clear();
    payload_.clear();
    start_ = 0;
    ++generation_;
  }
  /// Removes the records, which must have no payload, after the first `words` words.
  void rewind(std::size_t words) { words_.rewind(words); }
  /// Changes whenever the records are cleared, which invalidates earlier positions.
  std::uint64_t generation() const { return generation_; }

 private:
  void close() {
    std::uint64_t& header = words_.data()[start_];
    header = (header & 0xffff'ffffU) | std::uint64_t(words_.size() - start_) << 32;
  }

  Words words_;
  Words payload_;
  std::size_t start_ = 0;
  std::uint64_t generation_ = 0;
  std::size_t threshold_ = payload_threshold;
};

/// A record that is read; `words` includes the header.
struct Record {
  std::uint32_t id = 0;
  std::span<const std::uint64_t> words;
  std::span<const std::uint64_t> payload;  ///< of its block

  std::span<const std::uint64_t> arguments() const { return words.subspan(1); }
  /// The bytes that `word` refers to; nothing if it is not a reference to data that exists.
  std::optional<std::span<const std::byte>> bytes(std::uint64_t word) const {
    const Reference reference = Reference::from(word);
    const bool apart = reference.kind == ReferenceKind::payload;
    if (!apart && reference.kind != ReferenceKind::inside && reference.kind != ReferenceKind::strings &&
        reference.kind != ReferenceKind::lists) {
      return std::nullopt;
    }
    const std::span<const std::uint64_t> from = apart ? payload : words;
    if (reference.value >= from.size() || (!apart && reference.value == 0)) return std::nullopt;
    const std::uint64_t size = from[reference.value];
    if (size > (from.size() - reference.value - 1) * 8) return std::nullopt;
    return std::as_bytes(from.subspan(reference.value + 1)).first(size);
  }
};

/// The record that starts at `words[position]`; nothing if its length is invalid.
inline std::optional<Record> record_at(std::span<const std::uint64_t> words, std::size_t position,
                                       std::span<const std::uint64_t> payload) {
  if (position >= words.size()) return std::nullopt;
  const std::uint64_t length = words[position] >> 32;
  if (length == 0 || length > words.size() - position) return std::nullopt;
  return Record{std::uint32_t(words[position]), words.subspan(position, length), payload};
}

}  // namespace understudy::spu
