// SPDX-License-Identifier: Apache-2.0
// Expressions: evaluates nodes of the tree to values.
#include <utility>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// Points of one node at which values are merged.
enum ExpressionMeeting : std::uint32_t { at_right = 32 };

bool is_integer(const TType& type) {
  return type.isIntegerDomain();
}

double number_in(const TConstUnion& value) {
  switch (value.getType()) {
    case EbtInt:
      return value.getIConst();
    case EbtUint:
      return value.getUConst();
    case EbtBool:
      return value.getBConst() ? 1 : 0;
    case EbtInt64:
      return double(value.getI64Const());
    case EbtUint64:
      return double(value.getU64Const());
    case EbtFloat:
    case EbtDouble:
    case EbtFloat16:
      return value.getDConst();
    default:
      return 0;
  }
}

/// Returns the number of elements that an index can select, and the number of cells of each.
std::pair<std::size_t, std::size_t> elements_and_cells(const TType& type, std::size_t cells_of_value) {
  const std::size_t cells = type.isArray()    ? cells_of_element(type)
                            : type.isMatrix() ? std::size_t(type.getMatrixRows())
                                              : 1;
  return {cells_of_value / std::max(cells, std::size_t(1)), cells};
}

}  // namespace

Value Walk::evaluate(const TIntermTyped* node) {
  count_step();
  if (const auto* symbol = node->getAsSymbolNode()) return evaluate_symbol(*symbol);
  if (const auto* known = node->getAsConstantUnion()) return evaluate_constant(known->getConstArray());
  if (const auto* binary = node->getAsBinaryNode()) return evaluate_binary(*binary);
  if (const auto* unary = node->getAsUnaryNode()) return evaluate_unary(*unary);
  if (const auto* selection = node->getAsSelectionNode()) return evaluate_selection(*selection);
  if (const auto* aggregate = node->getAsAggregate()) return evaluate_aggregate(*aggregate);
  return unknown_value(node->getType(), "an expression of unknown kind");
}

Value Walk::unknown_value(const TType& type, const std::string& name) {
  const Set on = own_source(SourceKind::unknown, name);
  Value value;
  for (std::uint32_t i = 0; i < cells_of(type); ++i)
    value.push_back({on, values_.numbers.of(ValueNumbers::distinct, {std::uint32_t(steps_), i})});
  return value;
}

std::vector<Value> Walk::evaluate_all(const TIntermSequence& arguments) {
  std::vector<const TIntermTyped*> operands;
  for (const TIntermNode* argument : arguments) operands.push_back(argument->getAsTyped());
  return evaluate_operands(operands);
}

Value Walk::evaluate_symbol(const TIntermSymbol& symbol) {
  if (!symbol.getConstArray().empty()) return evaluate_constant(symbol.getConstArray());
  if (symbol.getConstSubtree() != nullptr) return evaluate(symbol.getConstSubtree());
  return read(*place_of(&symbol));
}

Value Walk::evaluate_constant(const TConstUnionArray& array) {
  Value value;
  for (int i = 0; i < array.size(); ++i) value.push_back(values_.constant(number_in(array[i])));
  return value;
}

Value Walk::evaluate_binary(const TIntermBinary& binary) {
  switch (binary.getOp()) {
    case EOpIndexDirect:
    case EOpIndexIndirect:
    case EOpIndexDirectStruct:
    case EOpVectorSwizzle:
      return evaluate_index(binary);
    case EOpAssign:
      return evaluate_assignment(binary);
    case EOpLogicalAnd:
    case EOpLogicalOr:
      return evaluate_logical(binary);
    default:
      break;
  }
  if (operator_of_assignment(binary.getOp()) != EOpNull) return evaluate_assignment(binary);
  const std::array types{&binary.getLeft()->getType(), &binary.getRight()->getType()};
  return apply(binary.getOp(), binary.getType(),
               evaluate_operands(std::array{binary.getLeft(), binary.getRight()}), types);
}

/// The right side is executed only if the left side does not decide.
Value Walk::evaluate_logical(const TIntermBinary& binary) {
  const bool both = binary.getOp() == EOpLogicalAnd;
  const Scalar left = evaluate(binary.getLeft()).at(0);
  Scalar right = values_.constant(both ? 0 : 1);
  const std::function<void()> evaluate_right = [&] { right = evaluate(binary.getRight()).at(0); };
  const std::function<void()> nothing = [] {};
  either(left, binary, both ? evaluate_right : nothing, both ? nothing : evaluate_right);
  return values_.componentwise(binary.getOp(), 1, std::array{Value{left}, Value{right}}, true);
}

Value Walk::evaluate_selection(const TIntermSelection& selection) {
  const Scalar condition = evaluate(selection.getCondition()).at(0);
  const auto known = values_.numbers.constant_of(condition.number);
  Value when_true;
  Value when_false;
  either(
      condition, selection, [&] { when_true = evaluate(selection.getTrueBlock()->getAsTyped()); },
      [&] { when_false = evaluate(selection.getFalseBlock()->getAsTyped()); });
  if (known) return *known != 0 ? when_true : when_false;
  const Set decided_by = values_.sets.by(Flow::branch, condition.on);
  for (std::size_t i = 0; i < when_true.size() && i < when_false.size(); ++i) {
    if (when_true[i].number == when_false[i].number) continue;
    const Set on = values_.sets.join(values_.union_of(std::array{when_true[i], when_false[i]}), decided_by);
    when_true[i] = {on, values_.numbers.of(ValueNumbers::select,
                                           {condition.number, when_true[i].number, when_false[i].number})};
  }
  return when_true;
}

Value Walk::evaluate_index(const TIntermBinary& binary) {
  if (const auto place = place_of(&binary)) return read(*place);
  const Value base = evaluate(binary.getLeft());
  const TType& type = binary.getLeft()->getType();
  if (binary.getOp() == EOpVectorSwizzle) return swizzled(base, *binary.getRight()->getAsAggregate());
  const Scalar index = evaluate(binary.getRight()).at(0);
  const auto known = values_.numbers.constant_of(index.number);
  if (binary.getOp() == EOpIndexDirectStruct) {
    const auto first = base.begin() + cells_before_member(type, std::size_t(known.value_or(0)));
    return {first, first + cells_of(binary.getType())};
  }
  const auto [elements, cells] = elements_and_cells(type, base.size());
  return known && *known >= 0 && *known < double(elements) ? element_of(base, std::size_t(*known), cells)
                                                           : any_element_of(base, index, cells);
}

Value Walk::swizzled(const Value& base, const TIntermAggregate& components) {
  Value value;
  for (const TIntermNode* component : components.getSequence())
    value.push_back(base.at(std::size_t(component->getAsConstantUnion()->getConstArray()[0].getIConst())));
  return value;
}

Value Walk::element_of(const Value& base, std::size_t element, std::size_t cells) {
  const auto first = base.begin() + std::ptrdiff_t(element * cells);
  return {first, first + std::ptrdiff_t(cells)};
}

Value Walk::any_element_of(const Value& base, const Scalar& index, std::size_t cells) {
  Value value;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    std::vector<Scalar> candidates{index};
    for (std::size_t i = cell; i < base.size(); i += cells) candidates.push_back(base[i]);
    value.push_back(values_.combine(EOpIndexIndirect, candidates));
  }
  return value;
}

Value Walk::evaluate_assignment(const TIntermBinary& binary) {
  const TOperator op = operator_of_assignment(binary.getOp());
  const auto place_before = effects_.has(binary.getRight()) ? place_of(binary.getLeft()) : std::nullopt;
  const std::vector<Value> operands = evaluate_assigned(binary, op != EOpNull);
  auto place = place_of(binary.getLeft());
  if (!place) return unknown_assignment(binary);
  if (place_before) add_choice(*place, *place_before);
  const std::array types{&binary.getLeft()->getType(), &binary.getRight()->getType()};
  Value value = op == EOpNull ? operands[0] : apply(op, binary.getLeft()->getType(), operands, types);
  write(*place, value, binary.getLoc().line);
  return value;
}

/// Returns the value of the right side; for `x += y` preceded by that of the left side.
std::vector<Value> Walk::evaluate_assigned(const TIntermBinary& binary, bool with_left) {
  const TIntermTyped* left = binary.getLeft();
  const TIntermTyped* right = binary.getRight();
  if (effects_.has(left)) {
    if (with_left || effects_.has(right)) throw NotFollowed{"two changes of variables in one expression"};
    // The right side may be read before or after the left side changes what the right side reads.
    const State before = state_;
    place_of(left);
    const Value after = evaluate(right);
    state_ = before;
    Value value = evaluate(right);
    blend(value, after, point(binary, at_right));
    return {value};
  }
  if (!with_left) return {evaluate(right)};
  return evaluate_operands(std::array{left, right});
}

Value Walk::unknown_assignment(const TIntermBinary& binary) {
  // Valid GLSL does not get here; otherwise every cell may have been written.
  Value value = unknown_value(binary.getType(), "an assignment to what is no variable");
  for (Scalar& cell : state_.cells) {
    if (!value.empty()) cell = value[0];
  }
  return value;
}

Value Walk::evaluate_unary(const TIntermUnary& unary) {
  const TOperator op = unary.getOp();
  if (is_increment(op)) return evaluate_increment(unary);
  if (op == EOpArrayLength) return {values_.mixed(op, 1, std::array{evaluate(unary.getOperand())})};
  if (unary.isTexture()) return query_texture(unary, {evaluate(unary.getOperand())});
  if (op == EOpAtomicCounter || op == EOpAtomicCounterIncrement || op == EOpAtomicCounterDecrement)
    return change_atomically(unary, {evaluate(unary.getOperand())}, SideEffectKind::atomic_counter,
                             name_of(evaluate(unary.getOperand()).at(0)));
  const std::array operands{evaluate(unary.getOperand())};
  const std::array types{&unary.getOperand()->getType()};
  if (unary.isConstructor()) return values_.componentwise(op, cells_of(unary.getType()), operands, false);
  return apply(op, unary.getType(), operands, types);
}

Value Walk::evaluate_increment(const TIntermUnary& unary) {
  const auto place = place_of(unary.getOperand());
  const bool before = unary.getOp() == EOpPostIncrement || unary.getOp() == EOpPostDecrement;
  const bool up = unary.getOp() == EOpPostIncrement || unary.getOp() == EOpPreIncrement;
  const std::array operands{place ? read(*place) : evaluate(unary.getOperand()), Value{values_.constant(1)}};
  Value after =
      values_.componentwise(up ? EOpAdd : EOpSub, operands[0].size(), operands, is_integer(unary.getType()));
  if (place) write(*place, after, unary.getLoc().line);
  return before ? operands[0] : after;
}

Value Walk::evaluate_sequence(const TIntermAggregate& aggregate) {
  Value last;
  for (const TIntermNode* child : aggregate.getSequence()) {
    if (const auto* typed = child->getAsTyped())
      last = evaluate(typed);
    else
      execute(child);
  }
  return last;
}

Value Walk::evaluate_aggregate(const TIntermAggregate& aggregate) {
  const TOperator op = aggregate.getOp();
  if (op == EOpComma || op == EOpSequence || op == EOpScope) return evaluate_sequence(aggregate);
  if (op == EOpFunctionCall) return call(aggregate);
  if (aggregate.isConstructor()) return construct(aggregate.getType(), aggregate.getSequence());
  if (aggregate.isSampling()) return fetch(aggregate);
  if (aggregate.isTexture()) return query_texture(aggregate, evaluate_all(aggregate.getSequence()));
  if (aggregate.isImage()) return use_image(aggregate);
  return call_builtin(aggregate);
}

}  // namespace understudy::spu::program
