// SPDX-License-Identifier: Apache-2.0
// Operands, which GLSL allows to be read in any order: if one of them changes variables, the others may read
// them before or after the change.
#include <algorithm>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// Points of one node at which values are merged.
enum OrderMeeting : std::uint32_t { before_or_after = 48, of_operands };

}  // namespace

std::vector<Value> Walk::one_after_the_other(std::span<const TIntermTyped* const> operands) {
  std::vector<Value> values;
  values.reserve(operands.size());
  for (const TIntermTyped* operand : operands) values.push_back(evaluate(operand));
  return values;
}

std::vector<Value> Walk::evaluate_operands(std::span<const TIntermTyped* const> operands) {
  const bool open = operands.size() > 1 && std::ranges::any_of(operands, [&](const TIntermTyped* operand) {
                      return effects_.has(operand);
                    });
  if (!open) return one_after_the_other(operands);
  const Number here = point(*operands[0], before_or_after);
  State any = state_;
  std::vector<Value> values = one_after_the_other(operands);
  State after = state_;
  bool changed = true;
  while (changed && state_.reachable) {
    blend(any.cells, state_.cells, here);
    state_ = any;
    changed = false;
    const std::vector<Value> again = one_after_the_other(operands);
    for (std::size_t i = 0; i < values.size(); ++i)
      changed |= blend(values[i], again[i], point(*operands[i], of_operands));
    changed |= blend(after.cells, state_.cells, here);
  }
  state_ = std::move(after);
  return values;
}

/// Merges each scalar with that in `other`; returns false if nothing is new.
bool Walk::blend(std::vector<Scalar>& scalars, const std::vector<Scalar>& other, Number point) {
  bool changed = false;
  for (std::size_t i = 0; i < scalars.size() && i < other.size(); ++i) {
    if (scalars[i].number == other[i].number) continue;
    const Scalar either{values_.sets.join(scalars[i].on, other[i].on),
                        values_.numbers.of(ValueNumbers::merged, {point, Number(i)})};
    changed |= !(either == scalars[i]);
    scalars[i] = either;
  }
  return changed;
}

}  // namespace understudy::spu::program
