// SPDX-License-Identifier: Apache-2.0
// Fields of a message as bytes: every scalar takes eight bytes, every run of bytes is padded to a multiple of
// eight, and numbers are in the machine's own order (the peers share one machine or one kind of machine,
// little-endian).
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::compositor {

static_assert(std::endian::native == std::endian::little,
              "the messages are little-endian and are not converted");

/// A message that cannot be trusted. The text names message, field and offset.
class MalformedMessage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Writer {
 public:
  void integer(std::int64_t value) { append(&value, sizeof value); }
  void real(double value) { append(&value, sizeof value); }
  /// Writes a length and that many bytes.
  void run(std::span<const std::byte> bytes) {
    integer(std::int64_t(bytes.size()));
    append(bytes.data(), bytes.size());
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  std::vector<std::byte> bytes_;
};

/// Reads what a Writer wrote. Each function throws MalformedMessage if the bytes end early or the value is
/// outside the stated range; every length is compared with its limit and with the bytes left before it is used.
class Reader {
 public:
  Reader(std::string_view message, std::span<const std::byte> bytes) : message_(message), bytes_(bytes) {}

  std::int64_t integer(std::string_view field, std::int64_t low, std::int64_t high);
  int small(std::string_view field, int low, int high) { return int(integer(field, low, high)); }
  /// Any bit pattern: ids and counters.
  std::uint64_t word(std::string_view field);
  bool flag(std::string_view field) { return integer(field, 0, 1) != 0; }
  /// Any bit pattern: volume::validate() decides whether the value makes sense.
  double real(std::string_view field);
  /// A number that fits a float (or infinity, or NaN).
  float real32(std::string_view field);
  /// A run of at most `max` bytes, as a view of the message.
  std::span<const std::byte> run(std::string_view field, std::uint64_t max);
  /// A run of plain values, at most `max` of them.
  template <class T>
  std::vector<T> values(std::string_view field, std::uint64_t max) {
    const std::span<const std::byte> bytes = run(field, max * sizeof(T));
    if (bytes.size() % sizeof(T) != 0) fail(field, "is not a whole number of values");
    std::vector<T> result(bytes.size() / sizeof(T));
    if (!result.empty()) std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
  /// An enumerator no greater than `last`.
  template <class Enum>
  Enum enumerator(std::string_view field, Enum last) {
    return Enum(integer(field, 0, std::int64_t(last)));
  }
  /// Throws if bytes are left over.
  void end();

  [[noreturn]] void fail(std::string_view field, std::string_view what) const;

 private:
  void take(std::string_view field, void* to, std::size_t size);

  std::string_view message_;
  std::span<const std::byte> bytes_;
  std::size_t offset_ = 0;  ///< of the next field
  std::size_t field_ = 0;   ///< of the field being read
};

}  // namespace understudy::compositor
