// SPDX-License-Identifier: Apache-2.0
// Joins of paths through the program.
#include <algorithm>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

void Walk::meet(State& state, const State& other, Set decided_by, Number point) {
  if (!other.reachable) return;
  if (!state.reachable) {
    state = other;
    return;
  }
  for (std::size_t cell = 0; cell < state.cells.size(); ++cell) {
    Scalar& here = state.cells[cell];
    const Scalar& there = other.cells[cell];
    if (here == there) continue;
    here.on = values_.sets.join(here.on, there.on);
    // If both paths bring the same value, it does not matter which was taken.
    if (here.number == there.number) continue;
    here.on = values_.sets.join(here.on, decided_by);
    here.number = values_.numbers.of(ValueNumbers::merged, {point, here.number, there.number});
  }
}

void Walk::add_exit(Exit& exit, const State& state, Set decided_by, Number point) {
  if (!state.reachable) return;
  exit.decided_by = values_.sets.join(exit.decided_by, decided_by);
  meet(exit.state, state, exit.decided_by, point);
}

Walk::Number Walk::point(const TIntermNode& node, std::uint32_t which) {
  const auto [high, low] = halves(reinterpret_cast<std::uintptr_t>(&node));
  return values_.numbers.of(ValueNumbers::merged, {path_, high, low, which});
}

/// Returns what distinguishes a path that ends here from those that go on to the same join. Earlier exits count
/// if they joined what follows elsewhere, after a switch; after loops, Target::ends_by includes them.
Walk::Set Walk::parting() {
  const bool in_switch = std::ranges::any_of(targets_, [](const Target* target) { return !target->loop; });
  return in_switch ? conditions_in_loop() : conditions_.branches;
}

Walk::Set Walk::conditions_in_loop() {
  return values_.sets.join(conditions_.branches, conditions_.passed);
}

Walk::Set Walk::conditions_in_function() {
  const Set around = values_.sets.join(conditions_.around, conditions_.passed_around);
  return values_.sets.join(around, conditions_in_loop());
}

Walk::Set Walk::conditions() {
  return values_.sets.join(conditions_.outside, conditions_in_function());
}

}  // namespace understudy::spu::program
