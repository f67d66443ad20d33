#include "spu/chain.h"

#include <algorithm>

namespace understudy::spu {
namespace {

thread_local Chain* current_chain = nullptr;

}  // namespace

Chain::Chain(const DispatchTable& driver, std::shared_ptr<ShareGroup> group,
             void (*switch_table)(const DispatchTable*))
    : driver_(driver), group_(std::move(group)), switch_table_(switch_table) {}

Chain::~Chain() {
  if (current_chain == this) release_current();
}

Chain* Chain::current() {
  return current_chain;
}

void Chain::make_current() {
  current_chain = this;
  set_phase(phase_);
}

void Chain::release_current() {
  if (current_chain != nullptr) current_chain->switch_table_(nullptr);
  current_chain = nullptr;
}

void Chain::build(Phase phase) const {
  auto& tables = tables_[int(phase)];
  tables.resize(units_.size());
  for (std::size_t u = units_.size(); u-- > 0;) {
    const DispatchTable& next = u + 1 < units_.size() ? *tables[u + 1] : driver_;
    tables[u] = std::make_unique<DispatchTable>(next);
    units_[u]->fill(phase, *tables[u]);
  }
}

const DispatchTable& Chain::head(Phase phase) const {
  if (units_.empty()) return driver_;
  if (tables_[int(phase)].empty()) build(phase);
  return *tables_[int(phase)].front();
}

void Chain::set_phase(Phase phase) {
  phase_ = phase;
  switch_table_(&head(phase));
}

const DispatchTable& Chain::below(const Unit& unit, Phase phase) const {
  if (tables_[int(phase)].empty()) build(phase);
  for (std::size_t u = 0; u + 1 < units_.size(); ++u) {
    if (units_[u].get() == &unit) return *tables_[int(phase)][u + 1];
  }
  return driver_;
}

const DispatchTable& Chain::face(const Unit& unit, Phase phase) const {
  if (tables_[int(phase)].empty()) build(phase);
  for (std::size_t u = 0; u < units_.size(); ++u) {
    if (units_[u].get() == &unit) return *tables_[int(phase)][u];
  }
  return driver_;
}

void Chain::settle() {
  for (const auto& unit : units_) unit->settle();
}

void Chain::frame_ended(FrameEnd kind) {
  for (const auto& unit : units_) unit->frame_ended(kind);
}

void Chain::abandon() {
  for (const auto& unit : units_) unit->abandon();
}

}  // namespace understudy::spu
