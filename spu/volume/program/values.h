// SPDX-License-Identifier: Apache-2.0
// Values as the analysis represents them, and arithmetic on them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "spu/volume/program/flow_sets.h"
#include "spu/volume/program/value_numbers.h"

namespace understudy::spu::program {

/// A scalar: what it can depend on, and a number that it shares with equal scalars.
struct Scalar {
  FlowSets::Set on = FlowSets::empty;
  ValueNumbers::Number number = 0;
  bool operator==(const Scalar&) const = default;
};

/// Scalars, vectors, matrices (column by column), arrays and structures.
using Value = std::vector<Scalar>;

/// Sets and numbers of one analysis. The first `leaves` of both are values that come from outside.
class Values {
 public:
  using Set = FlowSets::Set;
  using Number = ValueNumbers::Number;

  explicit Values(std::uint32_t leaves) : sets(leaves), numbers(leaves) {}

  /// The scalar from outside with number `leaf`.
  static Scalar leaf(std::uint32_t leaf) { return {leaf + 1, leaf}; }
  Scalar constant(double value) { return {FlowSets::empty, numbers.of_constant(value)}; }
  /// Constant zeros.
  Value zeros(std::size_t cells) { return Value(cells, constant(0)); }

  /// `op` applied to all operands.
  Scalar combine(std::uint32_t op, std::span<const Scalar> operands);
  /// Component i depends on component i of each operand, or on its only one. `exact`: integers or booleans,
  /// whose constants are folded.
  Value componentwise(std::uint32_t op, std::size_t cells, std::span<const Value> operands, bool exact);
  /// Every component depends on all components of all operands.
  Value mixed(std::uint32_t op, std::size_t cells, std::span<const Value> operands);
  /// Matrix times matrix, matrix times vector, and vector times matrix: `left` has `rows` rows, and sums run
  /// over `inner` products.
  Value product(std::uint32_t op, const Value& left, const Value& right, std::size_t rows, std::size_t inner);
  /// `matrix` has `rows` rows.
  Value transposed(const Value& matrix, std::size_t rows);
  Value outer_product(std::uint32_t op, const Value& column, const Value& row);
  Value cross_product(std::uint32_t op, const Value& left, const Value& right);

  /// The same values, with further dependences.
  Value with(Value value, Set on);
  Set union_of(std::span<const Scalar> scalars);

  FlowSets sets;
  ValueNumbers numbers;

 private:
  std::optional<Scalar> unchanged(std::uint32_t op, std::span<const Scalar> operands) const;
  std::optional<double> folded(std::uint32_t op, std::span<const Scalar> operands) const;
};

}  // namespace understudy::spu::program
