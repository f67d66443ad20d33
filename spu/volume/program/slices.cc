// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/slices.h"

#include <algorithm>
#include <set>

namespace understudy::spu::program {
namespace {

/// Returns whether the source is the same for all fragments of a draw, or undefined, on which no viewer relies.
bool is_fixed(SourceKind kind) {
  return kind == SourceKind::uniform || kind == SourceKind::uniform_block || kind == SourceKind::texture_size ||
         kind == SourceKind::iteration || kind == SourceKind::undefined;
}

bool depends_on_iteration(const StageFacts& facts, const Fetch& fetch) {
  const auto is_iteration = [&](const Dependence& dependence) {
    return facts.sources[dependence.source].kind == SourceKind::iteration;
  };
  return std::ranges::any_of(
             fetch.coordinate,
             [&](const Dependences& component) { return std::ranges::any_of(component, is_iteration); }) ||
         std::ranges::any_of(fetch.modifiers, is_iteration);
}

bool is_varying(const StageFacts& facts, const std::optional<std::uint32_t>& exact) {
  return exact && facts.sources[*exact].kind == SourceKind::varying;
}

void sort_out(const StageFacts& facts, const Influence& influence, SliceFinding& finding,
              std::set<std::string>& tables) {
  const Source& source = facts.sources[influence.source];
  if (is_fixed(source.kind)) return;
  if (source.kind == SourceKind::texel) {
    const bool of_volume = std::ranges::find(finding.texels, source.number) != finding.texels.end();
    if (!of_volume) tables.insert(source.name);
    if (influence.target == Target::coordinate) finding.coordinate_others.push_back(influence);
  } else if (influence.target != Target::coordinate) {
    finding.others.push_back(influence);
  } else {
    (source.kind == SourceKind::varying ? finding.coordinate_varyings : finding.coordinate_others)
        .push_back(influence);
  }
}

/// Keeps the first of the fetches that read one texel.
std::vector<std::size_t> different(const StageFacts& facts, const std::vector<std::size_t>& fetches) {
  std::vector<std::size_t> kept;
  std::set<std::uint32_t> places;
  for (const std::size_t fetch : fetches) {
    if (places.insert(facts.fetches[fetch].place).second) kept.push_back(fetch);
  }
  return kept;
}

std::string text_of_second(const StageFacts& facts, const Fetch& first, const Fetch& second) {
  std::set<std::string> varyings;
  for (const Dependences& component : second.coordinate) {
    for (const Dependence& dependence : component) {
      const Source& source = facts.sources[dependence.source];
      if (source.kind == SourceKind::varying) varyings.insert(source.name);
    }
  }
  for (const Dependences& component : first.coordinate) {
    for (const Dependence& dependence : component) varyings.erase(facts.sources[dependence.source].name);
  }
  const std::string text = "colours depend on a second texel of '" + second.sampler + "'";
  return varyings.empty() ? text + " at an offset" : text + " at varying " + *varyings.begin();
}

std::vector<std::string> reasons_of(const StageFacts& facts, const SliceFinding& finding) {
  std::vector<std::string> reasons;
  for (const SideEffect& effect : facts.side_effects) reasons.push_back("it writes to '" + effect.name + "'");
  for (const std::string& name : facts.not_followed) reasons.push_back("what " + name + " does is not known");
  if (finding.texels.empty()) reasons.emplace_back("colours do not depend on the volume");
  for (std::size_t i = 1; i < finding.texels.size(); ++i) {
    std::string reason =
        text_of_second(facts, facts.fetches[finding.texels[0]], facts.fetches[finding.texels[i]]);
    if (std::ranges::find(reasons, reason) == reasons.end()) reasons.push_back(std::move(reason));
  }
  if (finding.texels_vary_in_loop) reasons.emplace_back("colours depend on several texels, fetched in a loop");
  for (const auto* list : {&finding.others, &finding.coordinate_others}) {
    for (std::string& reason : texts(facts, *list)) reasons.push_back(std::move(reason));
  }
  return reasons;
}

}  // namespace

SliceFinding slice_finding(const StageFacts& fragment, std::span<const std::string> volumes) {
  const std::vector<Influence> all = influences(fragment, volumes);
  SliceFinding finding;
  const std::vector<std::size_t> fetches = volume_fetches(fragment, all, volumes);
  finding.texels = fetches;
  std::set<std::string> tables;
  for (const Influence& influence : all) sort_out(fragment, influence, finding, tables);
  finding.texels = different(fragment, fetches);
  for (const std::size_t fetch : finding.texels)
    finding.texels_vary_in_loop |= depends_on_iteration(fragment, fragment.fetches[fetch]);
  if (!finding.texels.empty())
    finding.coordinate_is_varying =
        std::ranges::all_of(fragment.fetches[finding.texels[0]].exact,
                            [&](const auto& exact) { return is_varying(fragment, exact); });
  finding.uniforms = uniform_uses(fragment, all);
  finding.side_effects = !fragment.side_effects.empty();
  finding.tables.assign(tables.begin(), tables.end());
  finding.reasons = reasons_of(fragment, finding);
  return finding;
}

}  // namespace understudy::spu::program
