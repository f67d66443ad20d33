// SPDX-License-Identifier: Apache-2.0
// Random shader programs: each is refused, or the results of its analysis are consistent. The first byte
// chooses the shader stage.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "spu/volume/program/analysis.h"
#include "spu/volume/program/ray_caster.h"
#include "spu/volume/program/slices.h"

namespace {

using namespace understudy::spu::program;

void check(const StageFacts& facts, const Dependences& dependences) {
  for (const Dependence& dependence : dependences)
    if (dependence.source >= facts.sources.size()) std::abort();
}

void check(const StageFacts& facts) {
  for (const Source& source : facts.sources) {
    if (source.kind == SourceKind::texel && source.number >= facts.fetches.size()) std::abort();
    if (source.component < 0 || source.component >= source.components) std::abort();
  }
  for (const Output& output : facts.outputs) check(facts, output.on);
  for (const Discard& discard : facts.discards) check(facts, discard.on);
  for (const Loop& loop : facts.loops) check(facts, loop.condition);
  for (const Fetch& fetch : facts.fetches) {
    for (const Dependences& component : fetch.coordinate) check(facts, component);
    if (fetch.loop && *fetch.loop >= facts.loops.size()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<std::string> sources{std::string(reinterpret_cast<const char*>(data) + 1, size - 1)};
  const StageFinding finding =
      sources[0].starts_with("!!") ? analyse_assembly(sources[0]) : analyse(Stage(data[0] % 3), sources);
  if (const auto* facts = std::get_if<StageFacts>(&finding)) {
    check(*facts);
    const std::vector<std::string> volumes{facts->fetches.empty() ? "" : facts->fetches[0].sampler};
    slice_finding(*facts, volumes);
    ray_finding(*facts, volumes);
  }
  return 0;
}
