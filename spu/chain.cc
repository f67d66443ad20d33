// SPDX-License-Identifier: Apache-2.0
#include "spu/chain.h"

#include <algorithm>

namespace understudy::spu {
namespace {

constexpr std::array<Phase, phase_count> all_phases = {Phase::plain, Phase::watching, Phase::deferring,
                                                       Phase::depth_deferred, Phase::compiling};

}  // namespace

constinit thread_local Chain* Chain::current_ = nullptr;

Chain::Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
             void (*switch_table)(const DispatchTable*), Surroundings surroundings)
    : driver_(driver), group_(std::move(group)), surroundings_(surroundings), switch_table_(switch_table) {}

Chain::~Chain() {
  if (current_ != this) return;
  switch_table_(nullptr);
  current_ = nullptr;
}

void Chain::make_current() {
  current_ = this;
  set_phase(phase_);
  for (const Place& place : units_) place.unit->made_current();
}

void Chain::release_current() {
  if (current_ == nullptr) return;
  for (const Place& place : current_->units_) place.unit->left();
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
  while (!units_.empty()) units_.pop_back();
  for (auto& tables : tables_) tables.clear();
}

void Chain::build(Phase phase) const {
  auto& tables = tables_[std::size_t(phase)];
  tables.resize(units_.size());
  for (std::size_t place = units_.size(); place-- > 0;) {
    const DispatchTable& next = below(place, phase);
    // A table stays where it is for ever: threads and units hold its address.
    if (!tables[place]) tables[place] = std::make_unique<DispatchTable>();
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

void Chain::set_phase(Phase phase) {
  phase_ = phase;
  switch_table_(&head(phase));
}

void Chain::settle() {
  for (const Place& place : units_) place.unit->settle();
}

void Chain::frame_ended(FrameEnd kind) {
  for (const Place& place : units_) place.unit->frame_ended(kind);
}

void Chain::abandon() {
  for (const Place& place : units_) place.unit->abandon();
}

void Chain::process_ends() {
  for (const Place& place : units_) place.unit->process_ends();
}

}  // namespace understudy::spu
