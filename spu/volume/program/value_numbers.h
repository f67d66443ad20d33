// SPDX-License-Identifier: Apache-2.0
// Value numbering: values with the same number are equal, whatever the inputs are (Alpern, Wegman and Zadeck
// 1988). Value numbers show that two fetches read one texel, and that a branch which changes nothing has no
// influence.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace understudy::spu::program {

class ValueNumbers {
 public:
  using Number = std::uint32_t;

  /// The first `leaves` numbers are values that come from outside.
  explicit ValueNumbers(std::uint32_t leaves) : leaves_(leaves) {}

  /// Operators of the front end have smaller numbers.
  enum Operator : std::uint32_t {
    constant = 1U << 20U,
    component,  ///< of a result whose components need all operands
    select,     ///< one of several values, by a condition
    merged,     ///< where paths through the program join
    head,       ///< at the head of a loop, in the current iteration
    path,       ///< a chain of calls
    place,      ///< of a texel
    distinct,   ///< differs from all others
  };

  /// Returns the number of `op` applied to `operands`, which no other operator or operands have.
  Number of(std::uint32_t op, std::span<const Number> operands);
  Number of(std::uint32_t op, std::initializer_list<Number> operands) {
    return of(op, std::span(operands.begin(), operands.size()));
  }
  Number of_constant(double value);

  bool is_leaf(Number number) const { return number < leaves_; }
  std::optional<double> constant_of(Number number) const;

 private:
  Number leaves_;
  std::unordered_multimap<std::uint64_t, Number> by_hash_;
  std::vector<std::uint32_t> terms_;       ///< operators and operands, one after the other
  std::vector<std::uint32_t> first_term_;  ///< by number, less leaves_
};

/// Splits a pointer, or any other 64 bits, into two operands.
inline std::array<std::uint32_t, 2> halves(std::uint64_t bits) {
  return {std::uint32_t(bits >> 32U), std::uint32_t(bits)};
}

}  // namespace understudy::spu::program
