// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/value_numbers.h"

#include <algorithm>
#include <bit>

#include "spu/volume/program/flow_sets.h"

namespace understudy::spu::program {
namespace {

std::uint64_t hash_of(std::uint32_t op, std::span<const std::uint32_t> operands) {
  std::uint64_t hash = (0xcbf29ce484222325U ^ op) * 0x100000001b3U;
  for (const std::uint32_t operand : operands) hash = (hash ^ operand) * 0x100000001b3U;
  return hash;
}

}  // namespace

ValueNumbers::Number ValueNumbers::of(std::uint32_t op, std::span<const Number> operands) {
  const std::uint64_t hash = hash_of(op, operands);
  const auto [first, last] = by_hash_.equal_range(hash);
  for (auto known = first; known != last; ++known) {
    const std::uint32_t* term = &terms_[first_term_[known->second - leaves_]];
    if (term[0] == op && term[1] == operands.size() && std::equal(operands.begin(), operands.end(), term + 2))
      return known->second;
  }
  if (terms_.size() > max_dependences_kept) throw TooLarge();
  const Number number = leaves_ + Number(first_term_.size());
  first_term_.push_back(std::uint32_t(terms_.size()));
  terms_.push_back(op);
  terms_.push_back(std::uint32_t(operands.size()));
  terms_.insert(terms_.end(), operands.begin(), operands.end());
  by_hash_.emplace(hash, number);
  return number;
}

ValueNumbers::Number ValueNumbers::of_constant(double value) {
  return of(constant, halves(std::bit_cast<std::uint64_t>(value)));
}

std::optional<double> ValueNumbers::constant_of(Number number) const {
  if (is_leaf(number)) return std::nullopt;
  const std::uint32_t* term = &terms_[first_term_[number - leaves_]];
  if (term[0] != constant) return std::nullopt;
  return std::bit_cast<double>(std::uint64_t(term[2]) << 32U | term[3]);
}

}  // namespace understudy::spu::program
