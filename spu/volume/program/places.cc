// SPDX-License-Identifier: Apache-2.0
// Places that can be assigned to: variables, their elements, members and components.
#include <algorithm>
#include <numeric>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// Limit of the elements that one expression may select from.
constexpr std::size_t max_choices = 4096;

}  // namespace

std::optional<Place> Walk::place_of(const TIntermTyped* node) {
  if (const auto* symbol = node->getAsSymbolNode()) {
    if (!symbol->getConstArray().empty()) return std::nullopt;
    const Variable& variable = variables_.of(*symbol);
    Place place{.variable = &variable, .starts = {variable.first}, .shared = variable.collapsed};
    place.parts.resize(variable.cells);
    std::iota(place.parts.begin(), place.parts.end(), 0U);
    return place;
  }
  const auto* binary = node->getAsBinaryNode();
  if (binary == nullptr) return std::nullopt;
  switch (binary->getOp()) {
    case EOpIndexDirect:
    case EOpIndexIndirect:
    case EOpIndexDirectStruct:
    case EOpVectorSwizzle:
      break;
    default:
      return std::nullopt;
  }
  auto base = place_of(binary->getLeft());
  if (!base) return std::nullopt;
  return indexed(*binary, std::move(*base));
}

Place Walk::indexed(const TIntermBinary& binary, Place base) {
  const TType& type = binary.getLeft()->getType();
  if (binary.getOp() == EOpVectorSwizzle) {
    std::vector<std::uint32_t> parts;
    for (const TIntermNode* component : binary.getRight()->getAsAggregate()->getSequence())
      parts.push_back(
          base.parts.at(std::size_t(component->getAsConstantUnion()->getConstArray()[0].getIConst())));
    base.parts = std::move(parts);
    return base;
  }
  const std::uint32_t cells = cells_of(binary.getType());
  if (binary.getOp() == EOpIndexDirectStruct) {
    const int member = binary.getRight()->getAsConstantUnion()->getConstArray()[0].getIConst();
    keep_parts(base, cells_before_member(type, std::size_t(member)), cells);
    return base;
  }
  index_by(base, evaluate(binary.getRight()).at(0), cells);
  return base;
}

void Walk::keep_parts(Place& place, std::size_t first, std::size_t count) {
  first = std::min(first, place.parts.size());
  count = std::min(count, place.parts.size() - first);
  place.parts.erase(place.parts.begin() + std::ptrdiff_t(first + count), place.parts.end());
  place.parts.erase(place.parts.begin(), place.parts.begin() + std::ptrdiff_t(first));
}

/// `cells`: of the selected element.
void Walk::index_by(Place& place, const Scalar& index, std::size_t cells) {
  const std::size_t elements = place.parts.size() / std::max(cells, std::size_t(1));
  const auto known = values_.numbers.constant_of(index.number);
  if (known && *known >= 0 && *known < double(elements) && !place.shared)
    return keep_parts(place, std::size_t(*known) * cells, cells);
  place.index = values_.sets.join(place.index, index.on);
  place.index_numbers.push_back(index.number);
  // Elements of a swizzled value are not equidistant.
  std::vector<std::vector<std::uint32_t>> choices;
  for (std::size_t element = 0; element < elements; ++element) {
    const auto first = place.parts.begin() + std::ptrdiff_t(element * cells);
    choices.emplace_back(first, first + std::ptrdiff_t(cells));
  }
  if (choices.empty()) return;
  std::vector<std::uint32_t> starts;
  for (const std::uint32_t start : place.starts) {
    for (const auto& choice : choices) starts.push_back(start + choice[0] - choices[0][0]);
  }
  if (starts.size() > max_choices) throw TooLarge();
  place.starts = std::move(starts);
  place.parts = choices[0];
}

/// Makes `other` an alternative location of `place`.
void Walk::add_choice(Place& place, const Place& other) {
  if (place.starts == other.starts && place.index_numbers == other.index_numbers) return;
  if (place.parts != other.parts) throw NotFollowed{"an index that changes while it is used"};
  place.starts.insert(place.starts.end(), other.starts.begin(), other.starts.end());
  place.index = values_.sets.join(place.index, other.index);
  place.index_numbers.insert(place.index_numbers.end(), other.index_numbers.begin(), other.index_numbers.end());
  if (place.index_numbers.empty())
    place.index_numbers.push_back(values_.numbers.of(ValueNumbers::distinct, {Number(steps_)}));
}

Value Walk::read(const Place& place) {
  Value value;
  value.reserve(place.parts.size());
  for (const std::uint32_t part : place.parts) {
    if (place.index_numbers.empty() && !place.shared) {
      value.push_back(state_.cells[place.starts[0] + part]);
      continue;
    }
    std::vector<Number> numbers = place.index_numbers;
    std::vector<Set> sets{place.index};
    for (const std::uint32_t start : place.starts) {
      const Scalar& cell = state_.cells[start + part];
      sets.push_back(cell.on);
      numbers.push_back(cell.number);
    }
    value.push_back({values_.sets.join(sets), values_.numbers.of(EOpIndexIndirect, numbers)});
  }
  return value;
}

void Walk::write(const Place& place, const Value& value, int line) {
  if (place.variable->storage == EvqBuffer)
    add_side_effect(SideEffectKind::buffer_store,
                    named(*place.variable, place.starts[0] + place.parts.at(0)).name, line);
  for (std::size_t i = 0; i < place.parts.size() && !value.empty(); ++i) {
    const Scalar& given = value[std::min(i, value.size() - 1)];
    if (place.index_numbers.empty() && !place.shared) {
      state_.cells[place.starts[0] + place.parts[i]] = given;
      continue;
    }
    for (const std::uint32_t start : place.starts)
      write_perhaps(place, start, state_.cells[start + place.parts[i]], given);
  }
}

/// Writes to an element that an index may or may not select.
void Walk::write_perhaps(const Place& place, std::uint32_t start, Scalar& cell, const Scalar& given) {
  std::vector<Number> numbers = place.index_numbers;
  numbers.insert(numbers.end(), {start, cell.number, given.number});
  cell.on = values_.sets.join(values_.sets.join(cell.on, given.on), place.index);
  cell.number = values_.numbers.of(EOpIndexIndirect, numbers);
}

}  // namespace understudy::spu::program
