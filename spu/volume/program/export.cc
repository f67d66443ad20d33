// SPDX-License-Identifier: Apache-2.0
// Exports what the walk has found as facts.
#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "spu/volume/program/walk.h"

namespace understudy::spu::program {

using namespace glslang;

/// Lists sources, each of them once. Variables of one name in several shaders of one stage are one source.
class Walk::SourceList {
 public:
  SourceList(const Variables& variables, const std::vector<Source>& own, std::vector<Source>& listed)
      : variables_(variables), own_(own), listed_(listed) {}

  std::uint32_t place_of(std::uint32_t source) {
    const auto [known, is_new] = place_by_source_.emplace(source, 0);
    if (!is_new) return known->second;
    Source described =
        source < variables_.cells() ? variables_.source_of(source) : own_[source - variables_.cells()];
    const auto key = std::tuple(described.kind, described.name, described.component, described.number);
    const auto [same, is_first] = place_by_key_.emplace(key, std::uint32_t(listed_.size()));
    if (is_first) listed_.push_back(std::move(described));
    return known->second = same->second;
  }

  Dependences listed(Dependences dependences) {
    for (Dependence& dependence : dependences) dependence.source = place_of(dependence.source);
    std::ranges::sort(dependences);
    dependences.erase(std::unique(dependences.begin(), dependences.end()), dependences.end());
    return dependences;
  }

 private:
  const Variables& variables_;
  const std::vector<Source>& own_;
  std::vector<Source>& listed_;
  std::map<std::uint32_t, std::uint32_t> place_by_source_;
  std::map<std::tuple<SourceKind, std::string, int, std::size_t>, std::uint32_t> place_by_key_;
};

namespace {

int location_of(const TQualifier& qualifier) {
  return qualifier.hasLocation() ? int(qualifier.layoutLocation) : -1;
}

int packed_at(const TQualifier& qualifier) {
  return qualifier.hasComponent() ? int(qualifier.layoutComponent) : 0;
}

Interpolation interpolation_of(const TQualifier& qualifier) {
  if (qualifier.flat) return Interpolation::flat;
  return qualifier.nopersp ? Interpolation::no_perspective : Interpolation::smooth;
}

bool is_declared_input(const Variable& variable) {
  return variable.storage == EvqVaryingIn;
}

Input input_of(const TType& type, std::string name, std::uint32_t cells, std::uint32_t elements) {
  const TQualifier& qualifier = type.getQualifier();
  return {.name = std::move(name),
          .components = int(cells / elements),
          .elements = int(elements),
          .integer = type.isIntegerDomain(),
          .location = location_of(qualifier),
          .packed_at = packed_at(qualifier),
          .interpolation = interpolation_of(qualifier),
          .centroid = qualifier.centroid,
          .sample = qualifier.sample};
}

bool has_locations(const TType& block) {
  return block.getQualifier().hasLocation() ||
         std::ranges::any_of(*block.getStruct(),
                             [](const TTypeLoc& member) { return member.type->getQualifier().hasLocation(); });
}

/// Returns the name of the interface block; empty if there is none, or if it has locations or is an array.
std::string block_of(const TType& type) {
  if (type.getBasicType() != EbtBlock || type.isArray() || has_locations(type)) return {};
  return type.getTypeName().c_str();
}

}  // namespace

StageFacts Walk::export_facts(int version) {
  StageFacts facts;
  facts.version = version;
  SourceList list(variables_, own_sources_, facts.sources);
  if (stage_ == Stage::geometry) state_ = emitted_;
  export_fetches(facts, list);
  export_outputs(facts, list);
  export_inputs(facts);
  for (const FoundLoop& loop : loops_)
    facts.loops.push_back({.condition = list.listed(values_.sets.members(loop.condition)),
                           .outer = loop.outer,
                           .line = loop.line});
  for (const auto& [point, discard] : discards_)
    facts.discards.push_back({.line = discard.line, .on = list.listed(values_.sets.members(discard.on))});
  facts.side_effects = side_effects_;
  facts.not_followed = not_followed_;
  return facts;
}

std::optional<std::uint32_t> Walk::exact_source(Number number, SourceList& list) {
  if (!values_.numbers.is_leaf(number) || number >= variables_.cells()) return std::nullopt;
  if (variables_.source_of(number).kind == SourceKind::undefined) return std::nullopt;
  return list.place_of(number);
}

void Walk::export_fetches(StageFacts& facts, SourceList& list) {
  for (const FoundFetch& found : fetches_) {
    Fetch fetch = found.fetch;
    for (std::size_t i = 0; i < found.coordinate.size(); ++i) {
      fetch.coordinate.push_back(list.listed(values_.sets.members(found.coordinate[i])));
      fetch.exact.push_back(exact_source(found.exact[i], list));
    }
    fetch.modifiers = list.listed(values_.sets.members(found.modifiers));
    fetch.execution = list.listed(values_.sets.members(found.execution));
    fetch.place = found.place;
    facts.fetches.push_back(std::move(fetch));
  }
}

void Walk::export_outputs(StageFacts& facts, SourceList& list) {
  for (const Variable& variable : variables_.list()) {
    if (!is_output(variable)) continue;
    const TQualifier& qualifier = variable.type->getQualifier();
    for (Cell cell = variable.first; cell < variable.first + variable.cells; ++cell) {
      const Source source = named(variable, cell);
      Output output{.name = source.name, .component = source.component, .components = source.components};
      output.location = location_of(qualifier);
      output.packed_at = packed_at(qualifier);
      if (qualifier.hasIndex()) output.index = int(qualifier.layoutIndex);
      output.interpolation = interpolation_of(qualifier);
      output.block = block_of(*variable.type);
      if (state_.reachable) {
        const Scalar& value = state_.cells[cell];
        output.written = value.number != cell;
        if (output.written) output.on = list.listed(values_.sets.members(value.on));
        output.exact = exact_source(value.number, list);
      }
      facts.outputs.push_back(std::move(output));
    }
  }
}

void Walk::export_inputs(StageFacts& facts) {
  for (const Variable& variable : variables_.list()) {
    if (!is_declared_input(variable) || variable.cells == 0) continue;
    const TType& type = *variable.type;
    const std::string block = block_of(type);
    if (block.empty()) {
      facts.inputs.push_back(input_of(type, variable.name, variable.cells, variable.elements));
      continue;
    }
    Cell first = variable.first;
    for (const TTypeLoc& member : *type.getStruct()) {
      const std::uint32_t cells = cells_of(*member.type);
      const std::uint32_t elements =
          member.type->isArray() ? cells / std::max(cells_of_element(*member.type), 1U) : 1;
      facts.inputs.push_back(
          input_of(*member.type, named(variable, first).name, cells, std::max(elements, 1U)));
      facts.inputs.back().block = block;
      first += cells;
    }
  }
}

}  // namespace understudy::spu::program
