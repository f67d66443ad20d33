// Calls kept as bytes: what the packed command stream is made of.
//
// A record is {uint16 call, uint16 words, arguments}, `words` counting 8-byte words with the header; it starts
// on an 8-byte boundary, every argument on its own natural boundary, gaps are zero. Chromium's packer
// (Humphreys 2002) with names instead of positional op-codes. This file is the machinery;
// dispatch/packed_call.h, generated, has one pack_X a command and replay().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// An argument `const T*` that the registry says points at N values.
template <class T, std::size_t N>
struct FixedArray {
  const T* first;
};

struct RecordHeader {
  std::uint16_t call;
  std::uint16_t words;
};

/// How one argument lies in a record: `Passed` is its type in the command's signature.
template <class Field>
struct FieldLayout {
  using Element = Field;
  using Passed = Field;
  static constexpr std::size_t count = 1;
  static void store(std::byte* to, Field value) { std::memcpy(to, &value, sizeof value); }
  static Passed load(const std::byte* from) {
    Field value;
    std::memcpy(&value, from, sizeof value);
    return value;
  }
};

template <class T, std::size_t N>
struct FieldLayout<FixedArray<T, N>> {
  using Element = T;
  using Passed = const T*;
  static constexpr std::size_t count = N;
  static void store(std::byte* to, FixedArray<T, N> values) { std::memcpy(to, values.first, N * sizeof(T)); }
  static Passed load(const std::byte* from) { return reinterpret_cast<const T*>(from); }
};

/// Where each argument of a record lies, in bytes from its start, and last where the record ends.
template <class... Fields>
constexpr std::array<std::size_t, sizeof...(Fields) + 1> record_layout() {
  std::array<std::size_t, sizeof...(Fields) + 1> starts{};
  std::size_t end = sizeof(RecordHeader);
  std::size_t field = 0;
  [[maybe_unused]] const auto place = [&](std::size_t element_size, std::size_t count) {
    starts[field++] = (end + element_size - 1) / element_size * element_size;  // scalars: boundary = size
    end = starts[field - 1] + element_size * count;
  };
  (place(sizeof(typename FieldLayout<Fields>::Element), FieldLayout<Fields>::count), ...);
  starts[field] = end;
  return starts;
}

template <class... Fields>
constexpr std::size_t record_words() {
  return (record_layout<Fields...>().back() + 7) / 8;
}

/// A growing list of packed calls.
class PackedCalls {
 public:
  template <class... Fields>
  void append(CallId call, const Fields&... fields) {
    constexpr std::size_t words = record_words<Fields...>();
    static_assert(words <= 0xffff);
    [[maybe_unused]] static constexpr auto starts = record_layout<Fields...>();
    [[maybe_unused]] std::byte* record = append_record(call, words);
    [[maybe_unused]] std::size_t field = 0;
    (FieldLayout<Fields>::store(record + starts[field++], fields), ...);
  }

  /// Appends the calls of another list.
  void append(std::span<const std::uint64_t> words) { words_.insert(words_.end(), words.begin(), words.end()); }

  std::span<const std::uint64_t> words() const { return words_; }
  bool empty() const { return words_.empty(); }
  void clear() { words_.clear(); }  ///< keeps the memory for the next calls

 private:
  /// Adds a record that is zero but for its header; valid until the next one is added.
  std::byte* append_record(CallId call, std::size_t words);

  std::vector<std::uint64_t> words_;
};

/// How far a replay came: `error` is null when every record was replayed.
struct ReplayEnd {
  std::size_t calls = 0;        ///< records replayed
  std::size_t words = 0;        ///< where the first record starts that was not
  const char* error = nullptr;  ///< what is wrong with it, in plain words
};

/// How to call a command from its record; `words` is 0 for a command that cannot be packed.
struct RecordShape {
  void (*call)(AnyFunction function, const std::byte* record) = nullptr;
  std::uint16_t words = 0;
};

template <class... Fields>
void call_from_record(AnyFunction function, [[maybe_unused]] const std::byte* record) {
  [[maybe_unused]] static constexpr auto starts = record_layout<Fields...>();
  const auto call = reinterpret_cast<void(APIENTRY*)(typename FieldLayout<Fields>::Passed...)>(function);
  [&]<std::size_t... Field>(std::index_sequence<Field...>) {
    call(FieldLayout<Fields>::load(record + starts[Field])...);
  }
  (std::index_sequence_for<Fields...>{});
}

template <class... Fields>
inline constexpr RecordShape record_shape{&call_from_record<Fields...>, record_words<Fields...>()};

/// Replays `words` on `table`; believes no length that does not fit both the record's shape and the bytes there
/// are.
ReplayEnd replay_records(std::span<const std::uint64_t> words, const DispatchTable& table,
                         std::span<const RecordShape, call_count> shapes);

}  // namespace understudy::spu
