// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/plain_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Light makes colours several times as bright, and programs clamp them: these are dark, and differ by much.
constexpr std::array<std::array<float, 3>, 3> plain_colours{
    {{0.25F, 0.05F, 0.12F}, {0.05F, 0.22F, 0.2F}, {0.15F, 0.12F, 0.03F}}};

/// By so many times the range of values are fields tried beyond it, where slopes are steep.
constexpr std::array<float, 7> places_in_range{0.5F, 0, 0.25F, 0.75F, 1, -20, 20};

/// The one table; null where there are none or several.
std::optional<SampledTexture> only_table(const MarchContext& measured) {
  if (measured.tables_of_samples.size() != 1) return std::nullopt;
  const Pipeline& pipeline = measured.run.pipeline();
  const GLint location =
      measured.context.gl->GetUniformLocation(pipeline.program, measured.tables_of_samples.front().c_str());
  for (const SampledTexture& table : pipeline.others) {
    if (table.sampler_location != location) continue;
    if (table.target == GL_TEXTURE_1D || table.target == GL_TEXTURE_2D) return table;
  }
  return std::nullopt;
}

/// Under the table, of even fields of these values.
std::vector<Rgba> under(FieldProbe& probe, const LitRay& ray, const FieldProbe::PlainTable& table,
                        std::span<const float> values) {
  probe.show_plain(table);
  std::vector<Rgba> shown = probe.at(ray.x, ray.y, values);
  probe.show_own(table.texture);
  return shown;
}

/// Of opacities of one sample, the one by which a ray lets about half of the light through.
std::optional<float> half_seen_opacity(FieldProbe& probe, const LitRay& ray, const SampledTexture& texture,
                                       float value) {
  constexpr float half = 0.6F;
  constexpr float farthest = 0.25F;
  std::optional<float> found;
  float least = farthest;
  for (const float opacity : {0.002F, 0.004F, 0.008F, 0.016F, 0.03F, 0.06F, 0.12F, 0.24F, 0.48F}) {
    const auto& [r, g, b] = plain_colours.front();
    const Rgba shown = under(probe, ray, {texture, {r, g, b, opacity}}, {&value, 1}).front();
    if (!reached(shown) || !(std::abs(shown[3] - half) < least)) continue;
    least = std::abs(shown[3] - half);
    found = opacity;
  }
  return found;
}

bool are_one_colour(const std::vector<Rgba>& shown) {
  constexpr float same = 2e-3F;
  return std::ranges::all_of(shown, [&](const Rgba& colour) {
    return reached(colour) && largest_difference(colour, shown.front()) <= same;
  });
}

}  // namespace

std::optional<LitRay> under_plain_tables(const MarchContext& measured, FieldProbe& probe, const March& march,
                                         const LitRay& ray) {
  constexpr double darkest = 1e-3;
  const auto texture = only_table(measured);
  if (!texture || march.background) return std::nullopt;
  const float width = measured.range[1] - measured.range[0];
  std::vector<float> values;
  values.reserve(places_in_range.size());
  for (const float place : places_in_range) values.push_back(measured.range[0] + place * width);
  const auto opacity = half_seen_opacity(probe, ray, *texture, values.front());
  if (!opacity) return std::nullopt;
  LitRay plain{ray.x, ray.y, ray.way};
  const bool already = premultiplied_already(measured, march);
  for (const auto& [r, g, b] : plain_colours) {
    const FieldProbe::PlainTable table{*texture, {r, g, b, *opacity}};
    const std::vector<Rgba> shown = under(probe, ray, table, values);
    if (!are_one_colour(shown)) return std::nullopt;
    plain.values.push_back(values.front());
    plain.base.push_back(premultiplied(shown.front(), already));
    plain.tables.push_back(table);
  }
  if (std::ranges::any_of(plain.base,
                          [](const Rgba& colour) { return !(double(brightest_channel(colour)) > darkest); }))
    return std::nullopt;
  const std::size_t samples = places_on_way(march.steps, ray.way.way).size();
  plain.plain_opacity = 1 - std::pow(1 - double(plain.base.front()[3]), 1 / double(samples));
  return plain;
}

}  // namespace understudy::spu
