// SPDX-License-Identifier: Apache-2.0
// Calls of the shader's own functions and of built-in ones.
#include <algorithm>
#include <utility>

#include "spu/volume/program/parameters.h"
#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

std::string plain_name(const TString& mangled) {
  const std::string name = mangled.c_str();
  return name.substr(0, name.find('('));
}

}  // namespace

Value Walk::call(const TIntermAggregate& node) {
  const Function* function = variables_.function(node.getName().c_str());
  if (function == nullptr || std::ranges::find(functions_, function) != functions_.end())
    return call_unknown(node);
  return call_function(node.getSequence(), node, *function);
}

Value Walk::call_function(const TIntermSequence& arguments, const TIntermNode& at, const Function& function) {
  const auto places = bind_parameters(arguments, function);
  const Conditions saved = conditions_;
  const auto targets = std::exchange(targets_, {});
  const auto [high, low] = halves(reinterpret_cast<std::uintptr_t>(&at));
  const Number path = std::exchange(path_, values_.numbers.of(ValueNumbers::path, {path_, high, low}));
  conditions_ = {.outside = conditions()};
  walk_body(function);
  conditions_ = saved;
  targets_ = targets;
  path_ = path;
  const TIntermSequence& parameters = parameters_of(function);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i]) write(*places[i], read(*place_of(parameters[i]->getAsTyped())), at.getLoc().line);
  }
  const auto first = state_.cells.begin() + function.returned;
  return {first, first + function.returned_cells};
}

/// Returns where the values that the function leaves in its parameters are written.
std::vector<std::optional<Place>> Walk::bind_parameters(const TIntermSequence& arguments,
                                                        const Function& function) {
  const TIntermSequence& parameters = parameters_of(function);
  const std::vector<Value> values = evaluate_all(arguments);
  std::vector<std::optional<Place>> places(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const TIntermTyped* argument = arguments.at(i)->getAsTyped();
    if (!is_written(parameters[i]->getAsTyped()->getQualifier().storage)) continue;
    if (effects_.has(argument)) throw NotFollowed{"a parameter that changes variables and is written to"};
    places[i] = place_of(argument);
  }
  forget_locals(function);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const TIntermSymbol* parameter = parameters[i]->getAsSymbolNode();
    if (parameter != nullptr && parameter->getQualifier().storage != EvqOut)
      write(*place_of(parameter), values[i], 0);
  }
  return places;
}

void Walk::walk_body(const Function& function) {
  Exit returned;
  functions_.push_back(&function);
  returns_.push_back(&returned);
  const TIntermSequence& parts = function.node->getSequence();
  for (std::size_t i = 1; i < parts.size(); ++i) execute(parts[i]);
  returns_.pop_back();
  functions_.pop_back();
  meet(state_, returned.state, returned.decided_by, point(*function.node, 0));
}

/// The variables of a function begin undefined in every call.
void Walk::forget_locals(const Function& function) {
  for (const std::size_t local : function.locals) {
    const Variable& variable = variables_.list()[local];
    for (Cell cell = variable.first; cell < variable.first + variable.cells; ++cell)
      state_.cells[cell] = Values::leaf(cell);
  }
  for (Cell cell = function.returned; cell < function.returned + function.returned_cells; ++cell)
    state_.cells[cell] = Values::leaf(cell);
}

Value Walk::call_unknown(const TIntermAggregate& node) {
  const std::string name = plain_name(node.getName());
  if (std::ranges::find(not_followed_, name) == not_followed_.end()) not_followed_.push_back(name);
  Set on = own_source(SourceKind::unknown, name);
  for (const Value& argument : evaluate_all(node.getSequence()))
    on = values_.sets.join(on, values_.union_of(argument));
  for (std::size_t i = 0; i < node.getSequence().size(); ++i) {
    const auto& qualifiers = node.getQualifierList();
    const auto place = place_of(node.getSequence()[i]->getAsTyped());
    if (place && (i >= qualifiers.size() || is_written(qualifiers[i])))
      write(*place, values_.with(unknown_value(node.getSequence()[i]->getAsTyped()->getType(), name), on), 0);
  }
  return values_.with(unknown_value(node.getType(), name), on);
}

Value Walk::call_builtin(const TIntermAggregate& node) {
  const TOperator op = node.getOp();
  if (op == EOpFtransform) return transformed_vertex();
  if (op == EOpEmitVertex || op == EOpEmitStreamVertex) emit_vertex(node);
  std::vector<Value> arguments = evaluate_all(node.getSequence());
  if (op >= EOpAtomicAdd && op <= EOpAtomicStore) return change_buffer_atomically(node, arguments);
  if (op >= EOpAtomicCounterIncrement && op <= EOpAtomicCounterCompSwap)
    return change_atomically(node, arguments, SideEffectKind::atomic_counter, name_of(arguments.at(0).at(0)));
  std::vector<const TType*> types;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    types.push_back(&node.getSequence()[i]->getAsTyped()->getType());
    if (writes_parameter(op, i)) arguments[i] = values_.zeros(arguments[i].size());
  }
  Value value = apply(op, node.getType(), arguments, types);
  if (const auto source = source_of_builtin(op)) value = values_.with(std::move(value), *source);
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (!writes_parameter(op, i)) continue;
    const TIntermTyped* parameter = node.getSequence()[i]->getAsTyped();
    if (const auto place = place_of(parameter))
      write(
          *place,
          values_.mixed(std::uint32_t(op) | ValueNumbers::component, cells_of(parameter->getType()), arguments),
          0);
  }
  return value;
}

/// Returns what a built-in function can depend on besides its arguments.
std::optional<Walk::Set> Walk::source_of_builtin(TOperator op) {
  if (op == EOpNoise) return own_source(SourceKind::noise, "noise");
  if (op >= EOpInterpolateAtCentroid && op <= EOpInterpolateAtVertex)
    return own_source(SourceKind::derivative, "derivative");
  const bool of_arguments = (op >= EOpRadians && op <= EOpFwidthCoarse) ||
                            (op >= EOpNegative && op <= EOpVectorSwizzle) ||
                            (op >= EOpMatrixTimesMatrix && op <= EOpTranspose) || op == EOpAny ||
                            op == EOpAll || (op >= EOpAddCarry && op <= EOpFindMSB) || op == EOpEmitVertex ||
                            op == EOpEndPrimitive || op == EOpEmitStreamVertex || op == EOpEndStreamPrimitive ||
                            op == EOpArrayLength || (op >= EOpBarrier && op <= EOpGroupMemoryBarrier);
  if (of_arguments) return std::nullopt;
  const std::string name = "built-in function number " + std::to_string(op);
  if (std::ranges::find(not_followed_, name) == not_followed_.end()) not_followed_.push_back(name);
  return own_source(SourceKind::unknown, name);
}

Value Walk::transformed_vertex() {
  Value matrix;
  Value vertex;
  for (Cell i = 0; i < 16; ++i) matrix.push_back(Values::leaf(variables_.fixed_matrix() + i));
  for (Cell i = 0; i < 4; ++i) vertex.push_back(Values::leaf(variables_.fixed_vertex() + i));
  return values_.product(EOpFtransform, matrix, vertex, 4, 4);
}

void Walk::emit_vertex(const TIntermNode& node) {
  meet(emitted_, state_, conditions(), point(node, 0));
}

}  // namespace understudy::spu::program
