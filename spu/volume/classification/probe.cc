// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/probe.h"

#include <fmt/format.h>

#include <utility>

#include "spu/volume/classification/colour_map_probe.h"
#include "spu/volume/classification/segment_probe.h"
#include "spu/volume/classification/table_probe.h"
#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

ProbeFinding probe_colours(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                           const TextureDescription& texture, const FragmentInputs& fragment,
                           const std::array<float, 2>& range) {
  if (texture.base == BaseFormat::rgba) return probe_map(bench, context, pipeline, texture, fragment);
  ProbeFinding finding = probe_table(bench, context, pipeline, texture, fragment, range);
  for (const std::size_t end : fragment.segment_ends) {
    if (std::holds_alternative<Probed>(finding)) break;
    if (auto segments = probe_segments(bench, context, pipeline, texture, fragment, range, end))
      finding = *std::move(segments);
  }
  return finding;
}

}  // namespace

ProbeFinding probe_classification(const GlContext& context, const Pipeline& pipeline,
                                  const TextureDescription& texture, const FragmentInputs& fragment,
                                  const std::array<float, 2>& range) {
  ProbeBench bench(context, pipeline);
  if (!bench.complete()) return "the driver offers no float framebuffer to probe with";
  std::string trouble;
  bench.own(probe_program(context, fragment.record.get(), fragment.inputs, fragment.coordinate, trouble));
  if (bench.program() == 0) return trouble;
  if (fragment.record != nullptr) {
    const std::string missing = copy_uniforms(context, fragment.application, bench.program());
    if (!missing.empty()) return not_copied(missing);
  }
  ProbeFinding finding = probe_colours(bench, context, pipeline, texture, fragment, range);
  if (bench.error() != GL_NO_ERROR)
    return Refusal{"the driver rejects what the fragment stage is probed with",
                   fmt::format("OpenGL error {:#x}", bench.error())};
  return finding;
}

}  // namespace understudy::spu
