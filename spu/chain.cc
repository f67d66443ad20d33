// SPDX-License-Identifier: Apache-2.0
#include "spu/chain.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <new>

#include "compositor/logging/log.h"
#include "dispatch/shell.h"
#include "spu/lost_context.h"

namespace understudy::spu {
namespace {

constexpr std::array<Phase, phase_count> all_phases = {Phase::plain, Phase::watching, Phase::deferring,
                                                       Phase::depth_deferred, Phase::compiling};

}  // namespace

constinit thread_local Chain* Chain::current_ = nullptr;

/// The shell between the application and the units of the current chain.
struct Chain::Guard {
  static const DispatchTable& guarded() { return *current_->guarded_; }
  [[gnu::cold, gnu::noinline]] static void failed() noexcept { current_->give_up_for_exception(); }
  [[gnu::cold, gnu::noinline]] static const DispatchTable& after_failure() noexcept {
    return current_->without_units();
  }
};

template <class Told>
void Chain::tell(Told told) {
  if (!given_up_) {
    for (const Place& place : units_) told(*place.unit);
    return;
  }
  for (const Place& place : units_) {
    try {
      told(*place.unit);
    } catch (...) {
      // The error was logged when the chain was given up.
    }
  }
}

Chain::Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
             void (*switch_table)(const DispatchTable*), Surroundings surroundings)
    : driver_(driver), group_(std::move(group)), surroundings_(surroundings), switch_table_(switch_table) {}

Chain::~Chain() {
  if (current_ == this) {
    switch_table_(nullptr);
    current_ = nullptr;
  }
  return_to_driver();
  units_.clear();
}

void Chain::make_current() {
  current_ = this;
  if (given_up_) return switch_table_(&without_units());
  set_phase(phase_);
  for (const Place& place : units_) place.unit->made_current();
}

void Chain::release_current() {
  if (current_ == nullptr) return;
  current_->after_call([] { current_->tell([](Unit& unit) { unit.left(); }); });
  current_->switch_table_(nullptr);
  current_ = nullptr;
}

void Chain::add(std::unique_ptr<Unit> unit) {
  unit->place_ = units_.size();
  const char* tag = unit->tag_address();
  units_.push_back({tag, std::move(unit)});
}

void Chain::remove_units() {
  replacements_.clear();
  return_to_driver();
  while (!units_.empty()) units_.pop_back();
  for (auto& tables : tables_) tables.clear();
  for (auto& table : guarded_tables_) table.reset();
}

void Chain::return_to_driver() {
  for (auto& tables : tables_) {
    for (auto& table : tables) *table = driver_;
  }
}

void Chain::build(Phase phase) const {
  auto& tables = tables_[std::size_t(phase)];
  // A table never moves, because threads and units hold its address. Either all are there, or none.
  if (tables.empty()) {
    std::vector<std::unique_ptr<DispatchTable>> made(units_.size());
    for (auto& table : made) table = std::make_unique<DispatchTable>(driver_);
    tables = std::move(made);
  }
  for (std::size_t place = units_.size(); place-- > 0;) {
    const DispatchTable& next = below(place, phase);
    DispatchTable& face = *tables[place];
    face = next;
    units_[place].unit->fill(phase, face);
    for (std::size_t i = 0; i < call_count; ++i) {
      if (slot(next, CallId(i)) == nullptr) set_slot(face, CallId(i), nullptr);
    }
    for (Replacement& replacement : replacements_) {
      if (replacement.place != place) continue;
      note_original(replacement, phase);
      set_slot(face, replacement.call, replacement.function);
    }
  }
  if (guarded_tables_[std::size_t(phase)]) build_guarded(phase);
}

void Chain::build_guarded(Phase phase) const {
  for (std::size_t i = 0; i < call_count; ++i) guard_slot(phase, CallId(i));
}

void Chain::guard_slot(Phase phase, CallId call) const {
  static const DispatchTable shells = [] {
    DispatchTable all{};
    Shell<Guard>::fill(all);
    return all;
  }();
  const AnyFunction own = slot(head(phase), call);
  set_slot(*guarded_tables_[std::size_t(phase)], call, own == slot(driver_, call) ? own : slot(shells, call));
}

void Chain::note_original(Replacement& replacement, Phase phase) const {
  const AnyFunction own = slot(*tables_[std::size_t(phase)][replacement.place], replacement.call);
  const bool inherited = own == slot(below(replacement.place, phase), replacement.call);
  replacement.originals[std::size_t(phase)] = {inherited, own};
}

std::vector<Chain::Replacement>::iterator Chain::find_replacement(const Unit& unit, CallId call) {
  return std::find_if(replacements_.begin(), replacements_.end(), [&](const Replacement& replacement) {
    return replacement.place == unit.place_ && replacement.call == call;
  });
}

void Chain::set_inherited(std::size_t place, Phase phase, CallId call, AnyFunction function) {
  const auto& tables = tables_[std::size_t(phase)];
  const AnyFunction before = slot(*tables[place], call);
  set_slot(*tables[place], call, function);
  while (place-- > 0 && slot(*tables[place], call) == before) set_slot(*tables[place], call, function);
  if (guarded_tables_[std::size_t(phase)]) guard_slot(phase, call);
}

void Chain::replace_slot(const Unit& unit, CallId call, AnyFunction function) {
  auto found = find_replacement(unit, call);
  const bool first = found == replacements_.end();
  if (first) found = replacements_.insert(found, {unit.place_, call, function, {}});
  found->function = function;
  for (const Phase phase : all_phases) {
    if (!built(phase)) continue;
    if (first) note_original(*found, phase);
    set_inherited(unit.place_, phase, call, function);
  }
}

void Chain::restore_slot(const Unit& unit, CallId call) {
  const auto found = find_replacement(unit, call);
  if (found == replacements_.end()) return;
  for (const Phase phase : all_phases) {
    if (!built(phase)) continue;
    const Original& original = found->originals[std::size_t(phase)];
    set_inherited(unit.place_, phase, call,
                  original.inherited ? slot(below(unit.place_, phase), call) : original.own);
  }
  replacements_.erase(found);
}

void Chain::refill() {
  for (const Phase phase : all_phases) {
    if (built(phase)) build(phase);
  }
}

const DispatchTable& Chain::face(const Unit& unit, Phase phase) const {
  if (!built(phase)) build(phase);
  return *tables_[std::size_t(phase)][unit.place_];
}

const DispatchTable& Chain::head(Phase phase) const {
  if (units_.empty()) return driver_;
  if (!built(phase)) build(phase);
  return *tables_[std::size_t(phase)].front();
}

const DispatchTable& Chain::guarded_head(Phase phase) const {
  if (units_.empty()) return driver_;
  auto& table = guarded_tables_[std::size_t(phase)];
  if (!table) {
    if (!built(phase)) build(phase);
    table = std::make_unique<DispatchTable>();
    build_guarded(phase);
  }
  return *table;
}

void Chain::set_phase(Phase phase) {
  if (given_up_) return;
  const DispatchTable& seen = guarded_head(phase);
  phase_ = phase;
  guarded_ = &head(phase);
  switch_table_(&seen);
}

const DispatchTable& Chain::without_units() const {
  return surroundings_.server != nullptr ? lost_context() : driver_;
}

void Chain::give_up(const char* trouble) noexcept {
  if (given_up_) return;
  given_up_ = true;
  tell([](Unit& unit) { unit.give_up(); });
  switch_table_(&without_units());
  static constinit std::atomic_flag said{};
  if (said.test_and_set()) return;
  // There may not be enough memory for a longer line.
  std::array<char, 512> line;
  std::snprintf(line.data(), line.size(), "%s; %s", trouble,
                surroundings_.server != nullptr
                    ? "its OpenGL context is lost, and nothing more of it is drawn; start the viewer again"
                    : "calls go straight to the driver, which draws all volumes of this context itself");
  logging::write(logging::Level::error, line.data());
}

void Chain::give_up_for_exception() noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    give_up("there is not enough memory");
  } catch (const std::exception& error) {
    give_up(error.what());
  } catch (...) {
    give_up("an unknown error");
  }
}

void Chain::settle() {
  if (given_up_) return;
  for (const Place& place : units_) place.unit->settle();
}

void Chain::frame_ended(FrameEnd kind) {
  if (given_up_) return;
  for (const Place& place : units_) place.unit->frame_ended(kind);
}

void Chain::abandon() {
  tell([](Unit& unit) { unit.abandon(); });
}

void Chain::process_ends() {
  tell([](Unit& unit) { unit.process_ends(); });
}

}  // namespace understudy::spu
