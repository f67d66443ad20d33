// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/values.h"

#include <glslang/Include/intermediate.h>

#include <algorithm>
#include <array>
#include <utility>

namespace understudy::spu::program {
namespace {

/// Distinguishes integers from floats: 1 / 2 is not 1.0 / 2.0.
constexpr std::uint32_t of_exact = 1U << 24U;

/// More sets than this are joined at once; unions of fewer are computed pair by pair, and found again.
constexpr std::size_t many = 16;

Scalar component_of(const Value& operand, std::size_t i) {
  return operand[operand.size() == 1 ? 0 : std::min(i, operand.size() - 1)];
}

/// Comparisons and logic decide branches, and integers are indices: more need not be folded.
std::optional<double> folded_numbers(std::uint32_t op, double a, double b) {
  switch (op) {
    case glslang::EOpNegative:
      return -a;
    case glslang::EOpAdd:
      return a + b;
    case glslang::EOpSub:
      return a - b;
    case glslang::EOpMul:
      return a * b;
    case glslang::EOpLogicalNot:
      return a == 0 ? 1 : 0;
    case glslang::EOpLogicalAnd:
      return a != 0 && b != 0 ? 1 : 0;
    case glslang::EOpLogicalOr:
      return a != 0 || b != 0 ? 1 : 0;
    case glslang::EOpEqual:
      return a == b ? 1 : 0;
    case glslang::EOpNotEqual:
      return a != b ? 1 : 0;
    case glslang::EOpLessThan:
      return a < b ? 1 : 0;
    case glslang::EOpGreaterThan:
      return a > b ? 1 : 0;
    case glslang::EOpLessThanEqual:
      return a <= b ? 1 : 0;
    case glslang::EOpGreaterThanEqual:
      return a >= b ? 1 : 0;
    default:
      return std::nullopt;
  }
}

}  // namespace

Scalar Values::combine(std::uint32_t op, std::span<const Scalar> operands) {
  std::vector<Number> numbers_of_operands;
  numbers_of_operands.reserve(operands.size());
  for (const Scalar& operand : operands) numbers_of_operands.push_back(operand.number);
  return {union_of(operands), numbers.of(op, numbers_of_operands)};
}

/// x + 0, x - 0, x * 1: texture functions that are called with an offset of zero read the same texel.
std::optional<Scalar> Values::unchanged(std::uint32_t op, std::span<const Scalar> operands) const {
  if (operands.size() != 2) return std::nullopt;
  const bool multiplied = op == glslang::EOpMul || op == glslang::EOpVectorTimesScalar;
  if (!multiplied && op != glslang::EOpAdd && op != glslang::EOpSub) return std::nullopt;
  const double neutral = multiplied ? 1 : 0;
  if (numbers.constant_of(operands[1].number) == neutral) return operands[0];
  if (op != glslang::EOpSub && numbers.constant_of(operands[0].number) == neutral) return operands[1];
  return std::nullopt;
}

std::optional<double> Values::folded(std::uint32_t op, std::span<const Scalar> operands) const {
  std::array<double, 2> known{};
  if (operands.empty() || operands.size() > known.size()) return std::nullopt;
  for (std::size_t i = 0; i < operands.size(); ++i) {
    const auto value = numbers.constant_of(operands[i].number);
    if (!value) return std::nullopt;
    known[i] = *value;
  }
  return folded_numbers(op, known[0], known[1]);
}

Value Values::componentwise(std::uint32_t op, std::size_t cells, std::span<const Value> operands, bool exact) {
  Value result;
  result.reserve(cells);
  std::vector<Scalar> components(operands.size());
  for (std::size_t i = 0; i < cells; ++i) {
    for (std::size_t k = 0; k < operands.size(); ++k) components[k] = component_of(operands[k], i);
    if (const auto same = unchanged(op, components)) {
      result.push_back(*same);
    } else if (const auto value = exact ? folded(op, components) : std::nullopt) {
      result.push_back({union_of(components), numbers.of_constant(*value)});
    } else {
      result.push_back(combine(exact ? op | of_exact : op, components));
    }
  }
  return result;
}

Value Values::mixed(std::uint32_t op, std::size_t cells, std::span<const Value> operands) {
  std::vector<Scalar> all;
  for (const Value& operand : operands) all.insert(all.end(), operand.begin(), operand.end());
  const Scalar whole = combine(op, all);
  if (cells == 1) return {whole};
  Value result;
  for (std::size_t i = 0; i < cells; ++i)
    result.push_back({whole.on, numbers.of(ValueNumbers::component, {whole.number, Number(i)})});
  return result;
}

Value Values::product(std::uint32_t op, const Value& left, const Value& right, std::size_t rows,
                      std::size_t inner) {
  Value result;
  const std::size_t columns = right.size() / std::max(inner, std::size_t(1));
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t row = 0; row < rows; ++row) {
      std::vector<Scalar> terms;
      for (std::size_t k = 0; k < inner; ++k) {
        terms.push_back(left[k * rows + row]);
        terms.push_back(right[column * inner + k]);
      }
      result.push_back(combine(op, terms));
    }
  }
  return result;
}

Value Values::transposed(const Value& matrix, std::size_t rows) {
  Value result;
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < matrix.size() / rows; ++column)
      result.push_back(matrix[column * rows + row]);
  }
  return result;
}

Value Values::outer_product(std::uint32_t op, const Value& column, const Value& row) {
  Value result;
  for (const Scalar& right : row) {
    for (const Scalar& left : column) result.push_back(combine(op, std::array{left, right}));
  }
  return result;
}

Value Values::cross_product(std::uint32_t op, const Value& left, const Value& right) {
  Value result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::size_t k = (i + 2) % 3;
    result.push_back(combine(op, std::array{left[j], right[k], left[k], right[j]}));
  }
  return result;
}

Value Values::with(Value value, Set on) {
  for (Scalar& scalar : value) scalar.on = sets.join(scalar.on, on);
  return value;
}

Values::Set Values::union_of(std::span<const Scalar> scalars) {
  if (scalars.size() > many) {
    std::vector<Set> each;
    for (const Scalar& scalar : scalars) each.push_back(scalar.on);
    return sets.join(each);
  }
  Set all = FlowSets::empty;
  for (const Scalar& scalar : scalars) all = sets.join(all, scalar.on);
  return all;
}

}  // namespace understudy::spu::program
