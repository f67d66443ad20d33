// SPDX-License-Identifier: Apache-2.0
#include "compositor/transport/wire.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace understudy::compositor {

void Reader::fail(std::string_view field, std::string_view what) const {
  throw MalformedMessage(fmt::format("{}: field '{}' at offset {} {}", message_, field, field_, what));
}

void Reader::take(std::string_view field, void* to, std::size_t size) {
  field_ = offset_;
  if (bytes_.size() - offset_ < size)
    fail(field, fmt::format("is missing: the message ends at {}", bytes_.size()));
  std::memcpy(to, bytes_.data() + offset_, size);
  offset_ += size;
}

std::int64_t Reader::integer(std::string_view field, std::int64_t low, std::int64_t high) {
  std::int64_t value = 0;
  take(field, &value, sizeof value);
  if (value < low || value > high) fail(field, fmt::format("is {}, outside [{}, {}]", value, low, high));
  return value;
}

std::uint64_t Reader::word(std::string_view field) {
  std::uint64_t value = 0;
  take(field, &value, sizeof value);
  return value;
}

double Reader::real(std::string_view field) {
  double value = 0;
  take(field, &value, sizeof value);
  return value;
}

float Reader::real32(std::string_view field) {
  const double value = real(field);
  if (std::isfinite(value) && std::abs(value) > double(std::numeric_limits<float>::max()))
    fail(field, "does not fit a float");
  return float(value);
}

std::span<const std::byte> Reader::run(std::string_view field, std::uint64_t max) {
  std::uint64_t length = 0;
  take(field, &length, sizeof length);
  if (length > max) fail(field, fmt::format("is {} bytes long, more than {}", length, max));
  const std::uint64_t left = bytes_.size() - offset_;
  // `length` is at most `max`, far from overflow.
  if ((length + 7) / 8 * 8 > left)
    fail(field, fmt::format("is {} bytes long, but only {} are left", length, left));
  const auto result = bytes_.subspan(offset_, std::size_t(length));
  offset_ += std::size_t((length + 7) / 8 * 8);
  return result;
}

void Reader::end() {
  field_ = offset_;
  if (offset_ != bytes_.size())
    throw MalformedMessage(
        fmt::format("{}: {} bytes too many after offset {}", message_, bytes_.size() - offset_, offset_));
}

}  // namespace understudy::compositor
