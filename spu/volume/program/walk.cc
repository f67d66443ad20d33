// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/walk.h"

#include <algorithm>
#include <utility>

namespace understudy::spu::program {

using namespace glslang;

Walk::Walk(Stage stage, const Variables& variables)
    : stage_(stage),
      variables_(variables),
      effects_(variables),
      values_(variables.cells()),
      path_(values_.numbers.of(ValueNumbers::path, {})) {
  state_.cells.reserve(variables.cells());
  for (Cell cell = 0; cell < variables.cells(); ++cell) state_.cells.push_back(Values::leaf(cell));
}

void Walk::assume(std::string_view name, int component, double value) {
  const std::string_view base = name.substr(0, name.find_first_of(".["));
  for (const Variable& variable : variables_.list()) {
    if (variable.storage != EvqUniform || variable.name != base || variable.collapsed) continue;
    for (Cell cell = variable.first; cell < variable.first + variable.cells; ++cell) {
      const Source source = named(variable, cell);
      if (source.name == name && source.component == component)
        state_.cells[cell].number = values_.numbers.of_constant(value);
    }
  }
}

StageFacts Walk::facts(const TIntermNode& root, int version) {
  const Function* main = variables_.function("main(");
  if (main == nullptr) throw NoMain();
  if (const auto* parts = root.getAsAggregate()) walk_globals(*parts);
  call_function({}, root, *main);
  return export_facts(version);
}

/// Global variables get their values before main begins.
void Walk::walk_globals(const TIntermAggregate& root) {
  Exit nowhere;
  returns_.push_back(&nowhere);
  for (const TIntermNode* part : root.getSequence()) {
    const auto* aggregate = part->getAsAggregate();
    const bool declares =
        aggregate != nullptr && (aggregate->getOp() == EOpFunction || aggregate->getOp() == EOpLinkerObjects);
    if (!declares) execute(part);
  }
  returns_.pop_back();
}

Walk::Set Walk::own_source(SourceKind kind, const std::string& name) {
  const auto [known, is_new] = own_source_by_name_.emplace(std::pair(kind, name), 0);
  if (is_new) known->second = add_source({.kind = kind, .name = name});
  return values_.sets.single(known->second);
}

std::uint32_t Walk::add_source(Source source) {
  own_sources_.push_back(std::move(source));
  return variables_.cells() + std::uint32_t(own_sources_.size()) - 1;
}

}  // namespace understudy::spu::program
