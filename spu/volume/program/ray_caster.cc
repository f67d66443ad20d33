// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/ray_caster.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace understudy::spu::program {
namespace {

/// Returns whether the source is the same for all fragments of a draw, or undefined, on which no viewer relies.
bool is_fixed_for_rays(SourceKind kind) {
  return kind == SourceKind::uniform || kind == SourceKind::uniform_block || kind == SourceKind::texture_size ||
         kind == SourceKind::undefined;
}

std::size_t outermost(const StageFacts& facts, std::size_t loop) {
  while (facts.loops[loop].outer) loop = *facts.loops[loop].outer;
  return loop;
}

bool of_samples(SourceKind kind) {
  return kind == SourceKind::texel || kind == SourceKind::iteration;
}

std::vector<Influence>& list_for(const Influence& influence, SourceKind kind, RayFinding& finding) {
  if (influence.target == Target::coordinate) return finding.coordinates;
  if (influence.target == Target::discard) return finding.discards;
  if (influence.flow == Flow::loop) return finding.loop_ends;
  if (influence.flow == Flow::data) return finding.data;
  return of_samples(kind) ? finding.guards : finding.branches;
}

/// Returns whether an influence is listed: texels that reach colours as data are what is to be shown.
bool counts(SourceKind kind, const Influence& influence) {
  if (is_fixed_for_rays(kind)) return false;
  const bool shown = influence.target == Target::colour && influence.flow == Flow::data;
  return !(shown && of_samples(kind));
}

void sort_fetches(const StageFacts& facts, const std::vector<std::size_t>& fetches, RayFinding& finding) {
  std::set<std::uint32_t> places;
  for (const std::size_t fetch : fetches) {
    const Fetch& what = facts.fetches[fetch];
    if (what.loop && !finding.loop) finding.loop = outermost(facts, *what.loop);
    if (!places.insert(what.place).second) continue;
    (what.loop ? finding.samples : finding.outside).push_back(fetch);
  }
}

/// Returns whether all fragments run through a loop equally often, whatever they have accumulated: one over the
/// axes.
bool runs_equally_often(const StageFacts& facts, std::size_t loop) {
  return std::ranges::all_of(facts.loops[loop].condition, [&](const Dependence& on) {
    const Source& source = facts.sources[on.source];
    return is_fixed_for_rays(source.kind) || (source.kind == SourceKind::iteration && source.number == loop);
  });
}

/// Returns whether only texels of the volume, possibly through other tables, and what is the same for the whole
/// draw reach the fetch's coordinate.
bool is_addressed_by_samples(const StageFacts& facts, const Fetch& fetch, std::span<const std::string> volumes,
                             int tables_deep = 0) {
  constexpr int most_tables_deep = 4;
  if (tables_deep > most_tables_deep) return false;
  const auto allowed = [&](const Dependence& on) {
    const Source& source = facts.sources[on.source];
    // A gradient may be computed axis by axis.
    if (source.kind == SourceKind::iteration)
      return facts.loops[source.number].outer && runs_equally_often(facts, source.number);
    if (source.kind != SourceKind::texel) return is_fixed_for_rays(source.kind);
    return std::ranges::find(volumes, source.name) != volumes.end() ||
           is_addressed_by_samples(facts, facts.fetches[source.number], volumes, tables_deep + 1);
  };
  return std::ranges::all_of(fetch.modifiers, allowed) &&
         std::ranges::all_of(fetch.coordinate, [&](const Dependences& component) {
           return std::ranges::all_of(component, allowed);
         });
}

std::vector<std::string> tables_of_samples(const StageFacts& facts, const std::set<std::string>& tables,
                                           std::span<const std::string> volumes) {
  std::vector<std::string> found;
  std::ranges::copy_if(tables, std::back_inserter(found), [&](const std::string& table) {
    return std::ranges::all_of(facts.fetches, [&](const Fetch& fetch) {
      return fetch.sampler != table || is_addressed_by_samples(facts, fetch, volumes);
    });
  });
  return found;
}

/// Adds the places of the volume's texels that reach the fetch's coordinate, possibly through other tables.
void add_places(const StageFacts& facts, const Fetch& fetch, std::span<const std::string> volumes,
                std::set<std::uint32_t>& places) {
  const auto add = [&](const Dependence& on) {
    const Source& source = facts.sources[on.source];
    if (source.kind != SourceKind::texel) return;
    const Fetch& before = facts.fetches[source.number];
    if (std::ranges::find(volumes, source.name) != volumes.end())
      places.insert(before.place);
    else
      add_places(facts, before, volumes, places);
  };
  std::ranges::for_each(fetch.modifiers, add);
  for (const Dependences& component : fetch.coordinate) std::ranges::for_each(component, add);
}

/// Returns the places of the texels that reach what is looked up in `table`.
std::set<std::uint32_t> places_that_address(const StageFacts& facts, const std::string& table,
                                            std::span<const std::string> volumes) {
  std::set<std::uint32_t> places;
  for (const Fetch& fetch : facts.fetches) {
    if (fetch.sampler == table) add_places(facts, fetch, volumes, places);
  }
  return places;
}

/// Sorts `finding.tables_of_samples` by the texels that reach them.
void sort_tables(const StageFacts& facts, std::span<const std::string> volumes, RayFinding& finding) {
  std::set<std::uint32_t> samples;
  for (const std::string& table : finding.tables_of_samples) {
    const std::set<std::uint32_t> places = places_that_address(facts, table, volumes);
    if (places.size() != 1) continue;
    finding.tables_of_one_texel.push_back(table);
    samples.insert(places.begin(), places.end());
  }
  // Without a table of samples, it is unknown which texel is the sample.
  if (samples.empty()) return;
  for (const std::string& table : finding.tables_of_samples) {
    const std::set<std::uint32_t> places = places_that_address(facts, table, volumes);
    const auto of_sample = [&](std::uint32_t place) { return samples.contains(place); };
    if (places.size() > 1 && std::ranges::none_of(places, of_sample))
      finding.tables_of_gradients.push_back(table);
  }
}

void add_once(std::vector<std::string>& reasons, std::string reason) {
  if (std::ranges::find(reasons, reason) == reasons.end()) reasons.push_back(std::move(reason));
}

std::vector<std::string> reasons_of(const StageFacts& facts, const RayFinding& finding) {
  std::vector<std::string> reasons;
  for (const SideEffect& effect : facts.side_effects) add_once(reasons, "it writes to '" + effect.name + "'");
  for (const std::string& name : facts.not_followed) add_once(reasons, "what " + name + " does is not known");
  if (!finding.loop) add_once(reasons, "no loop fetches the volume");
  if (finding.samples.size() > 1)
    add_once(reasons, std::to_string(finding.samples.size()) + " texels of '" +
                          facts.fetches[finding.samples[0]].sampler + "' reach one sample");
  if (!finding.outside.empty())
    add_once(reasons, "colours depend on a texel of '" + facts.fetches[finding.outside[0]].sampler +
                          "' that is fetched outside the loop");
  for (const auto* list : {&finding.data, &finding.branches}) {
    for (std::string& reason : texts(facts, *list)) add_once(reasons, std::move(reason));
  }
  return reasons;
}

/// Returns the loop in one iteration of which all these fetches are executed; null: none.
std::optional<std::size_t> common_loop(const StageFacts& facts, std::span<const std::size_t> fetches) {
  const auto is_around_all = [&](std::size_t loop) {
    return std::ranges::all_of(fetches, [&](std::size_t fetch) {
      return facts.fetches[fetch].loop && is_within(facts, *facts.fetches[fetch].loop, loop);
    });
  };
  for (const std::size_t fetch : fetches) {
    const auto loop = facts.fetches[fetch].loop;
    if (loop && is_around_all(*loop)) return loop;
  }
  return std::nullopt;
}

/// Returns, for each component of a fetch's coordinate, the sources that are neither the same for the whole
/// draw nor counted by a loop within `around`.
std::vector<std::set<std::uint32_t>> varying_places(const StageFacts& facts, const Fetch& fetch,
                                                    std::size_t around) {
  const auto is_counted = [&](const Source& source) {
    return source.kind == SourceKind::iteration && source.number != around &&
           is_within(facts, source.number, around) && runs_equally_often(facts, source.number);
  };
  std::vector<std::set<std::uint32_t>> places;
  for (const Dependences& component : fetch.coordinate) {
    std::set<std::uint32_t> sources;
    for (const Dependence& on : component) {
      const Source& source = facts.sources[on.source];
      if (!is_fixed_for_rays(source.kind) && !is_counted(source)) sources.insert(on.source);
    }
    places.push_back(std::move(sources));
  }
  return places;
}

/// Returns whether the coordinate of the fetch depends on the size of its own texture, or, unless `own`, of
/// another.
bool depends_on_size(const StageFacts& facts, const Fetch& fetch, bool own) {
  return std::ranges::any_of(fetch.coordinate, [&](const Dependences& component) {
    return std::ranges::any_of(component, [&](const Dependence& on) {
      const Source& source = facts.sources[on.source];
      return source.kind == SourceKind::texture_size && (source.name == fetch.sampler) == own;
    });
  });
}

/// Returns whether a fetch differs from others by its coordinate only.
bool is_plain(const StageFacts& facts, const Fetch& fetch) {
  const bool fixed = std::ranges::all_of(
      fetch.modifiers, [&](const Dependence& on) { return is_fixed_for_rays(facts.sources[on.source].kind); });
  return fetch.function == FetchFunction::filtered && fixed && !fetch.gradient && !fetch.bias;
}

}  // namespace

bool is_within(const StageFacts& facts, std::size_t inner, std::size_t outer) {
  for (std::optional<std::size_t> loop = inner; loop; loop = facts.loops[*loop].outer) {
    if (*loop == outer) return true;
  }
  return false;
}

std::optional<NeighbourDistance> neighbour_distance(const StageFacts& fragment,
                                                    std::span<const std::size_t> fetches) {
  const auto loop = common_loop(fragment, fetches);
  if (!loop) return std::nullopt;
  const auto places = varying_places(fragment, fragment.fetches[fetches.front()], *loop);
  const bool neighbours = std::ranges::all_of(fetches, [&](std::size_t index) {
    const Fetch& fetch = fragment.fetches[index];
    return is_plain(fragment, fetch) && !depends_on_size(fragment, fetch, false) &&
           varying_places(fragment, fetch, *loop) == places;
  });
  if (!neighbours) return std::nullopt;
  const auto by_texels = std::ranges::count_if(fetches, [&](std::size_t index) {
    const Fetch& fetch = fragment.fetches[index];
    return fetch.offset || depends_on_size(fragment, fetch, true);
  });
  if (by_texels == 0) return NeighbourDistance::in_texture_space;
  // All but the point itself: distances in both units would change differently from texture to texture.
  if (std::size_t(by_texels) + 1 == fetches.size()) return NeighbourDistance::in_texels;
  return std::nullopt;
}

bool address_tables_alone(const StageFacts& fragment, std::span<const std::size_t> fetches,
                          std::span<const std::string> others) {
  std::map<std::string, std::set<std::uint32_t>> places_by_table;
  for (const Fetch& table : fragment.fetches) {
    if (std::ranges::find(others, table.sampler) != others.end()) continue;
    for (const Dependences& component : table.coordinate) {
      for (const Dependence& on : component) {
        const Source& source = fragment.sources[on.source];
        if (source.kind == SourceKind::texel && std::ranges::find(fetches, source.number) != fetches.end())
          places_by_table[table.sampler].insert(fragment.fetches[source.number].place);
      }
    }
  }
  return std::ranges::all_of(places_by_table, [](const auto& table) { return table.second.size() <= 1; });
}

RayFinding ray_finding(const StageFacts& fragment, std::span<const std::string> volumes) {
  const std::vector<Influence> all = influences(fragment, volumes);
  RayFinding finding;
  sort_fetches(fragment, volume_fetches(fragment, all, volumes), finding);
  std::set<std::string> tables;
  for (const Influence& influence : all) {
    const Source& source = fragment.sources[influence.source];
    const bool of_volume = std::ranges::find(volumes, source.name) != volumes.end();
    if (source.kind == SourceKind::texel && !of_volume) tables.insert(source.name);
    finding.writes_depth |= influence.target == Target::depth;
    finding.discards_by_place |= influence.target == Target::discard &&
                                 source.kind == SourceKind::fragment_coordinate && source.component < 2;
    if (counts(source.kind, influence)) list_for(influence, source.kind, finding).push_back(influence);
  }
  finding.uniforms = uniform_uses(fragment, all);
  finding.side_effects = !fragment.side_effects.empty();
  finding.tables.assign(tables.begin(), tables.end());
  finding.tables_of_samples = tables_of_samples(fragment, tables, volumes);
  sort_tables(fragment, volumes, finding);
  finding.reasons = reasons_of(fragment, finding);
  return finding;
}

}  // namespace understudy::spu::program
