// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/effects.h"

#include <algorithm>

#include "spu/volume/program/operators.h"
#include "spu/volume/program/parameters.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// Returns the target of an assignment or increment; null for other nodes.
const TIntermNode* assigned(const TIntermNode& node) {
  if (const auto* binary = node.getAsBinaryNode()) {
    const bool assigns = binary->getOp() == EOpAssign || operator_of_assignment(binary->getOp()) != EOpNull;
    return assigns ? binary->getLeft() : nullptr;
  }
  const auto* unary = node.getAsUnaryNode();
  return unary != nullptr && is_increment(unary->getOp()) ? unary->getOperand() : nullptr;
}

const TIntermSymbol* root_of(const TIntermNode* target) {
  while (const auto* binary = target->getAsBinaryNode()) target = binary->getLeft();
  return target->getAsSymbolNode();
}

}  // namespace

bool Effects::has(const TIntermNode* node) {
  if (node == nullptr) return false;
  if (const auto known = known_.find(node); known != known_.end()) return known->second;
  bool found = assigned(*node) != nullptr;
  if (const auto* aggregate = node->getAsAggregate()) found = found || of_call(*aggregate);
  if (!found) for_each_child(*node, [&](const TIntermNode* child) { found = found || has(child); });
  return known_[node] = found;
}

/// Returns the arguments that the call writes to.
std::vector<const TIntermNode*> Effects::written_by(const TIntermAggregate& call) const {
  const Function* function =
      call.getOp() == EOpFunctionCall ? variables_.function(call.getName().c_str()) : nullptr;
  std::vector<const TIntermNode*> written;
  for (std::size_t i = 0; i < call.getSequence().size(); ++i) {
    const bool by_function =
        function != nullptr && is_written(parameters_of(*function).at(i)->getAsTyped()->getQualifier().storage);
    if (by_function || writes_parameter(call.getOp(), i)) written.push_back(call.getSequence()[i]);
  }
  return written;
}

bool Effects::of_call(const TIntermAggregate& call) {
  if (!written_by(call).empty()) return true;
  if (call.getOp() != EOpFunctionCall) return false;
  const Function* function = variables_.function(call.getName().c_str());
  return function == nullptr || of_function(*function);
}

bool Effects::of_function(const Function& function) {
  const auto [known, is_new] = functions_.emplace(&function, true);
  if (!is_new) return known->second;
  const bool found = reaches_out(function.node, function);
  return functions_[&function] = found;
}

bool Effects::outlasts(const TIntermNode* target, const Function& function) const {
  const TIntermSymbol* root = root_of(target);
  return root == nullptr || !variables_.is_local(*root, function);
}

bool Effects::reaches_out(const TIntermNode* node, const Function& function) {
  if (node == nullptr) return false;
  const auto lasts = [&](const TIntermNode* target) { return outlasts(target, function); };
  const TIntermNode* target = assigned(*node);
  if (target != nullptr && lasts(target)) return true;
  if (const auto* aggregate = node->getAsAggregate()) {
    if (std::ranges::any_of(written_by(*aggregate), lasts)) return true;
    if (aggregate->getOp() == EOpFunctionCall) {
      const Function* called = variables_.function(aggregate->getName().c_str());
      if (called == nullptr || of_function(*called)) return true;
    }
  }
  bool found = false;
  for_each_child(*node, [&](const TIntermNode* child) { found = found || reaches_out(child, function); });
  return found;
}

}  // namespace understudy::spu::program
