// SPDX-License-Identifier: Apache-2.0
// Loops: walked over until nothing new is found, then left with the state of the last iteration.
#include <utility>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

namespace {

enum LoopMeeting : std::uint32_t { at_test = 8, at_next, at_exit, at_return };

}  // namespace

void Walk::execute_loop(const TIntermLoop& loop) {
  const std::size_t number = loop_number(loop);
  const Conditions saved = conditions_;
  const std::optional<std::size_t> outer = std::exchange(loop_, number);
  conditions_.passed_around = values_.sets.join(conditions_.passed_around, conditions_.passed);
  conditions_.around = values_.sets.join(conditions_.around, parting());
  conditions_.branches = FlowSets::empty;
  Target target{.loop = true};
  targets_.push_back(&target);
  returns_.push_back(&target.returned);
  const State entry = state_;
  State head = entry;
  Set known = FlowSets::empty;
  do {
    known = target.ends_by;
    target.left = {};
    target.next = {};
    target.returned = {};
    state_ = head;
    conditions_.passed = target.lasting;
    pass_once(loop, target);
  } while (widen(loop, entry, head, loops_[number].source) || known != target.ends_by);
  returns_.pop_back();
  targets_.pop_back();
  conditions_ = saved;
  loop_ = outer;
  loops_[number].condition = target.ends_by;
  leave_loop(loop, entry, target);
}

void Walk::pass_once(const TIntermLoop& loop, Target& target) {
  conditions_.branches = FlowSets::empty;
  if (loop.testFirst()) test_loop(loop, target);
  execute(loop.getBody());
  meet(state_, target.next.state, target.next.decided_by, point(loop, at_next));
  conditions_.passed = target.lasting;
  if (loop.getTerminal() != nullptr && state_.reachable) evaluate(loop.getTerminal());
  if (!loop.testFirst()) test_loop(loop, target);
}

void Walk::test_loop(const TIntermLoop& loop, Target& target) {
  if (loop.getTest() == nullptr || !state_.reachable) return;
  const Scalar condition = evaluate(loop.getTest()).at(0);
  const auto known = values_.numbers.constant_of(condition.number);
  if (known && *known != 0) return;
  const Set decided_by = values_.sets.by(Flow::loop, condition.on);
  target.ends_by = values_.sets.join(target.ends_by, decided_by);
  add_exit(target.left, state_, decided_by, point(loop, at_test));
  conditions_.branches = values_.sets.join(conditions_.branches, decided_by);
  target.lasting = values_.sets.join(target.lasting, decided_by);
  if (known) state_.reachable = false;
}

/// Merges into `head` what the end of an iteration brings back to it; returns false if nothing is new.
bool Walk::widen(const TIntermLoop& loop, const State& entry, State& head, std::uint32_t iteration) {
  if (!state_.reachable) return false;
  bool changed = false;
  const Number here = point(loop, at_next);
  for (std::size_t cell = 0; cell < head.cells.size(); ++cell) {
    const Scalar& first = entry.cells[cell];
    const Scalar& back = state_.cells[cell];
    Scalar& kept = head.cells[cell];
    if (back == kept || (back.number == first.number && kept.number == first.number)) continue;
    Scalar wider = kept;
    wider.number = values_.numbers.of(ValueNumbers::head, {here, Number(cell)});
    wider.on = values_.sets.join(values_.sets.join(kept.on, back.on), values_.sets.single(iteration));
    changed |= !(wider == kept);
    kept = wider;
  }
  return changed;
}

void Walk::leave_loop(const TIntermLoop& loop, const State& entry, Target& target) {
  taint_changed(target.left.state, entry, target.ends_by);
  taint_changed(target.returned.state, entry, target.ends_by);
  if (target.returned.state.reachable) leave_function(loop, target);
  state_ = std::move(target.left.state);
}

/// Leaves the function by a return in the loop, and thereby the loops around it.
void Walk::leave_function(const TIntermLoop& loop, const Target& target) {
  const Set decided_by = values_.sets.join(target.returned.decided_by, target.ends_by);
  add_exit(*returns_.back(), target.returned.state,
           values_.sets.join(values_.sets.join(conditions_.around, parting()), decided_by),
           point(loop, at_return));
  conditions_.passed = values_.sets.join(conditions_.passed, decided_by);
  for (Target* outer : targets_) outer->lasting = values_.sets.join(outer->lasting, decided_by);
}

/// What an iteration has changed depends on which iteration was the last.
void Walk::taint_changed(State& state, const State& entry, Set by) {
  if (!state.reachable) return;
  for (std::size_t cell = 0; cell < entry.cells.size(); ++cell) {
    if (state.cells[cell].number != entry.cells[cell].number)
      state.cells[cell].on = values_.sets.join(state.cells[cell].on, by);
  }
}

std::size_t Walk::loop_number(const TIntermLoop& loop) {
  const auto [known, is_new] = loop_by_path_.emplace(point(loop, at_exit), loops_.size());
  if (is_new) {
    const std::uint32_t source =
        add_source({.kind = SourceKind::iteration, .name = "loop", .number = loops_.size()});
    loops_.push_back({.outer = loop_, .line = loop.getLoc().line, .source = source});
  }
  return known->second;
}

}  // namespace understudy::spu::program
