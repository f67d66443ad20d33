// SPDX-License-Identifier: Apache-2.0
// Statements: what is executed, and under which conditions.
#include <utility>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

/// A hundred times what the longest shader met so far takes.
constexpr std::size_t max_steps = 200'000;

/// Points of one node at which paths join.
enum StatementMeeting : std::uint32_t { at_end, at_break, at_case };

}  // namespace

void Walk::count_step() {
  if (++steps_ > max_steps) throw TooLarge();
}

void Walk::execute(const TIntermNode* node) {
  if (node == nullptr || !state_.reachable) return;
  count_step();
  if (const auto* loop = node->getAsLoopNode()) return execute_loop(*loop);
  if (const auto* selection = node->getAsSelectionNode()) return execute_selection(*selection);
  if (const auto* choice = node->getAsSwitchNode()) return execute_switch(*choice);
  if (const auto* branch = node->getAsBranchNode()) return execute_branch(*branch);
  const auto* aggregate = node->getAsAggregate();
  if (aggregate != nullptr && (aggregate->getOp() == EOpSequence || aggregate->getOp() == EOpScope)) {
    for (const TIntermNode* child : aggregate->getSequence()) execute(child);
  } else if (const auto* typed = node->getAsTyped()) {
    evaluate(typed);
  }
}

void Walk::execute_selection(const TIntermSelection& selection) {
  const Scalar condition = evaluate(selection.getCondition()).at(0);
  either(
      condition, selection, [&] { execute(selection.getTrueBlock()); },
      [&] { execute(selection.getFalseBlock()); });
}

void Walk::either(const Scalar& condition, const TIntermNode& at, const std::function<void()>& when_true,
                  const std::function<void()>& when_false) {
  if (const auto known = values_.numbers.constant_of(condition.number))
    return *known != 0 ? when_true() : when_false();
  const State before = state_;
  const Set saved = conditions_.branches;
  const Set decided_by = values_.sets.by(Flow::branch, condition.on);
  conditions_.branches = values_.sets.join(saved, decided_by);
  when_true();
  const State after_true = std::exchange(state_, before);
  when_false();
  conditions_.branches = saved;
  const Number way = values_.numbers.of(ValueNumbers::select, {condition.number, point(at, at_end)});
  meet(state_, after_true, decided_by, way);
}

void Walk::execute_branch(const TIntermBranch& branch) {
  switch (branch.getFlowOp()) {
    case EOpKill:
    case EOpTerminateInvocation:
      execute_discard(branch);
      state_.reachable = false;
      return;
    case EOpDemote:
      return execute_discard(branch);
    case EOpReturn:
      return execute_return(branch);
    case EOpBreak:
      return leave_target(branch, *targets_.back());
    case EOpContinue:
      return execute_continue(branch);
    default:
      return;
  }
}

/// What follows does not depend on a discard: a discarded fragment leaves nothing.
void Walk::execute_discard(const TIntermBranch& branch) {
  FoundDiscard& found = discards_[point(branch, at_end)];
  found.line = branch.getLoc().line;
  found.on = values_.sets.join(found.on, conditions());
}

void Walk::execute_return(const TIntermBranch& branch) {
  if (branch.getExpression() != nullptr) {
    const Value value = evaluate(branch.getExpression());
    const Function& function = *functions_.back();
    for (std::uint32_t i = 0; i < function.returned_cells && i < value.size(); ++i)
      state_.cells[function.returned + i] = value[i];
  }
  for (Target* target : targets_)
    target->ends_by = values_.sets.join(target->ends_by, values_.sets.by(Flow::loop, conditions_in_function()));
  add_exit(*returns_.back(), state_, values_.sets.join(conditions_.around, parting()), point(branch, at_break));
  for (Target* target : targets_) end_way(*target);
  conditions_.passed = conditions_in_loop();
  state_.reachable = false;
}

/// Later iterations are executed only if this path was not taken.
void Walk::end_way(Target& target) {
  target.lasting = values_.sets.join(target.lasting, conditions_in_loop());
}

void Walk::leave_target(const TIntermBranch& branch, Target& target) {
  const Set decided_by = conditions_in_loop();
  const Set ends_by = values_.sets.by(Flow::loop, decided_by);
  target.ends_by = values_.sets.join(target.ends_by, ends_by);
  add_exit(target.left, state_, target.loop ? ends_by : parting(), point(branch, at_break));
  end_way(target);
  conditions_.passed = decided_by;
  state_.reachable = false;
}

void Walk::execute_continue(const TIntermBranch& branch) {
  for (auto target = targets_.rbegin(); target != targets_.rend(); ++target) {
    if (!(*target)->loop) continue;
    add_exit((*target)->next, state_, parting(), point(branch, at_break));
    conditions_.passed = conditions_in_loop();
    state_.reachable = false;
    return;
  }
}

void Walk::execute_switch(const TIntermSwitch& choice) {
  const Scalar condition = evaluate(choice.getCondition()->getAsTyped()).at(0);
  const Set decided_by = values_.sets.by(Flow::branch, condition.on);
  const Set saved = conditions_.branches;
  conditions_.branches = values_.sets.join(saved, decided_by);
  const State before = std::exchange(state_, State{.cells = {}, .reachable = false});
  Target target;
  targets_.push_back(&target);
  bool has_default = false;
  for (const TIntermNode* child : choice.getBody()->getSequence()) {
    const auto* label = child->getAsBranchNode();
    const bool is_default = label != nullptr && label->getFlowOp() == EOpDefault;
    has_default |= is_default;
    if (is_default || (label != nullptr && label->getFlowOp() == EOpCase))
      meet(state_, before, decided_by, point(*child, at_case));
    else
      execute(child);
  }
  if (!has_default) meet(state_, before, decided_by, point(choice, at_case));
  targets_.pop_back();
  conditions_.branches = saved;
  meet(state_, target.left.state, values_.sets.join(decided_by, target.left.decided_by), point(choice, at_end));
}

}  // namespace understudy::spu::program
