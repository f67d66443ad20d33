// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/program/influences.h"

#include <algorithm>
#include <set>
#include <utility>

namespace understudy::spu::program {
namespace {

bool is_one_of(const std::string& sampler, std::span<const std::string> volumes) {
  return std::ranges::find(volumes, sampler) != volumes.end();
}

Target target_of(const Output& output) {
  if (output.name == "gl_FragDepth" || output.name == "gl_FragDepthEXT") return Target::depth;
  if (output.name.starts_with("gl_SampleMask") || output.name.starts_with("gl_FragStencilRef"))
    return Target::coverage;
  return Target::colour;
}

class Closure {
 public:
  Closure(const StageFacts& facts, std::span<const std::string> volumes) : facts_(facts), volumes_(volumes) {}

  void add(const Dependences& dependences, Influence way) {
    for (const Dependence& dependence : dependences) {
      Influence influence = way;
      influence.source = dependence.source;
      influence.flow = std::max(way.flow, dependence.flow);
      if (!found_.insert(influence).second) continue;
      const Source& source = facts_.sources[dependence.source];
      if (source.kind == SourceKind::texel) follow(facts_.fetches[source.number], influence);
    }
  }

  std::vector<Influence> found() const { return {found_.begin(), found_.end()}; }

 private:
  void follow(const Fetch& fetch, Influence way) {
    const bool of_volume = is_one_of(fetch.sampler, volumes_);
    if (of_volume) {
      way.target = Target::coordinate;
      way.flow = Flow::data;
      way.through_table = false;
    } else {
      way.through_table = true;
    }
    for (const Dependences& component : fetch.coordinate) add(component, way);
    add(fetch.modifiers, way);
  }

  const StageFacts& facts_;
  std::span<const std::string> volumes_;
  std::set<Influence> found_;
};

/// Predicate of a sentence; % stands for the subject.
std::string predicate(const Influence& influence) {
  switch (influence.target) {
    case Target::colour:
      return influence.flow == Flow::branch ? "% decides between colours" : "colours depend on %";
    case Target::depth:
      return "depth depends on %";
    case Target::coverage:
      return "coverage depends on %";
    case Target::discard:
      return "% decides which fragments are discarded";
    case Target::coordinate:
      break;
  }
  return "the volume's coordinate depends on %";
}

std::string sentence(std::string predicate, const std::string& subject) {
  return predicate.replace(predicate.find('%'), 1, subject);
}

/// The bits of `variable.component` are its components.
std::string text_of_components(Source variable) {
  const unsigned components = unsigned(variable.component);
  const bool vector = variable.rows == variable.components && variable.components <= 4;
  variable.component = 0;
  variable.components = 1;
  std::string words = text(variable);
  if (vector && variable.rows > 1) {
    words += '.';
    for (unsigned i = 0; i < 4; ++i) {
      if ((components >> i & 1U) != 0) words += "xyzw"[i];
    }
  }
  return words;
}

/// Returns the names by which the vertex stage writes a built-in input of the fragment stage.
std::vector<std::string> names_in_vertex_stage(const std::string& varying) {
  if (varying == "gl_Color") return {"gl_FrontColor", "gl_BackColor"};
  if (varying == "gl_SecondaryColor") return {"gl_FrontSecondaryColor", "gl_BackSecondaryColor"};
  return {varying};
}

}  // namespace

std::vector<Influence> influences(const StageFacts& fragment, std::span<const std::string> volumes) {
  Closure closure(fragment, volumes);
  for (const Output& output : fragment.outputs) closure.add(output.on, {.target = target_of(output)});
  for (const Discard& discard : fragment.discards) closure.add(discard.on, {.target = Target::discard});
  return closure.found();
}

std::vector<std::size_t> volume_fetches(const StageFacts& fragment, std::span<const Influence> influences,
                                        std::span<const std::string> volumes) {
  std::set<std::size_t> fetches;
  for (const Influence& influence : influences) {
    const Source& source = fragment.sources[influence.source];
    if (source.kind == SourceKind::texel && is_one_of(fragment.fetches[source.number].sampler, volumes))
      fetches.insert(source.number);
  }
  return {fetches.begin(), fetches.end()};
}

std::vector<UniformUse> uniform_uses(const StageFacts& fragment, std::span<const Influence> influences) {
  std::vector<UniformUse> uses;
  for (const Influence& influence : influences) {
    const SourceKind kind = fragment.sources[influence.source].kind;
    if (kind != SourceKind::uniform && kind != SourceKind::uniform_block) continue;
    if (uses.empty() || uses.back().source != influence.source) uses.push_back({.source = influence.source});
    UniformUse& use = uses.back();
    use.colour |= influence.target == Target::colour;
    use.depth |= influence.target == Target::depth || influence.target == Target::coverage;
    use.discard |= influence.target == Target::discard;
    use.coordinate |= influence.target == Target::coordinate;
    use.chooses_colour |= influence.target == Target::colour && influence.flow == Flow::branch;
    use.branch |= influence.flow == Flow::branch;
    use.loop_end |= influence.flow == Flow::loop;
  }
  return uses;
}

std::vector<std::string> texts(const StageFacts& fragment, std::span<const Influence> influences) {
  // By predicate and variable, its components.
  std::vector<std::pair<std::string, Source>> said;
  for (const Influence& influence : influences) {
    const Source& source = fragment.sources[influence.source];
    const std::string what = predicate(influence);
    const auto known = std::ranges::find_if(said, [&](const auto& other) {
      return other.first == what && other.second.kind == source.kind && other.second.name == source.name;
    });
    if (known == said.end())
      said.emplace_back(what, source).second.component = 1 << source.component;
    else
      known->second.component |= 1 << source.component;
  }
  std::vector<std::string> texts;
  texts.reserve(said.size());
  for (const auto& [what, variable] : said) texts.push_back(sentence(what, text_of_components(variable)));
  return texts;
}

std::optional<Dependences> written_from(const StageFacts& vertex, const Source& varying) {
  std::optional<Dependences> all;
  for (const std::string& name : names_in_vertex_stage(varying.name)) {
    for (const Output& output : vertex.outputs) {
      if (output.name != name || output.component != varying.component || !output.written) continue;
      if (!all) all.emplace();
      all->insert(all->end(), output.on.begin(), output.on.end());
    }
  }
  if (all) {
    std::ranges::sort(*all);
    all->erase(std::unique(all->begin(), all->end()), all->end());
  }
  return all;
}

bool is_constant_over_draw(const StageFacts& vertex, const Source& varying) {
  const auto from = written_from(vertex, varying);
  return from && std::ranges::all_of(*from, [&](const Dependence& dependence) {
           const SourceKind kind = vertex.sources[dependence.source].kind;
           return kind == SourceKind::uniform || kind == SourceKind::uniform_block ||
                  kind == SourceKind::texture_size || kind == SourceKind::iteration;
         });
}

}  // namespace understudy::spu::program
