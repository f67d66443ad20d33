// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/plain_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spu/volume/context/context.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Rather dark, because light makes colours brighter and programs clamp them, and clearly different.
constexpr std::array<std::array<float, 3>, 3> plain_colours{
    {{0.4F, 0.08F, 0.2F}, {0.08F, 0.35F, 0.3F}, {0.25F, 0.2F, 0.05F}}};

/// Places in the range of values, as fractions from its low end. The first is the ray's value, the last two lie
/// as far outside as steep slopes reach.
constexpr std::array<float, 7> places_in_range{0.5F, 0, 0.25F, 0.75F, 1, -30, 30};

/// What the program takes from a table.
enum class TableRole : std::uint8_t { colour_and_opacity, colour, opacity };

struct Table {
  SampledTexture texture;
  TableRole role = TableRole::colour_and_opacity;
};

/// Returns the tables that are looked up by samples; empty if one is not a texture of 1 or 2 dimensions.
std::vector<SampledTexture> textures_of_tables(const MarchContext& measured) {
  const Pipeline& pipeline = measured.run.pipeline();
  std::vector<SampledTexture> textures;
  for (const std::string& sampler : measured.tables_of_one_texel) {
    const GLint location = measured.context.gl->GetUniformLocation(pipeline.program, sampler.c_str());
    const auto table = std::ranges::find(pipeline.others, location, &SampledTexture::sampler_location);
    if (table == pipeline.others.end() || (table->target != GL_TEXTURE_1D && table->target != GL_TEXTURE_2D))
      return {};
    textures.push_back(*table);
  }
  return textures;
}

/// Returns one table that has both colours and opacities, or two, of which `of_opacity` has the opacities
/// (VTK's has them in every component). Empty if there are no such tables.
std::vector<Table> tables_with(const MarchContext& measured, std::size_t of_opacity) {
  constexpr std::size_t most = 2;
  const std::vector<SampledTexture> textures = textures_of_tables(measured);
  if (of_opacity >= textures.size() || textures.size() > most) return {};
  if (textures.size() == 1) return {{textures[0], TableRole::colour_and_opacity}};
  std::vector<Table> tables;
  for (std::size_t i = 0; i < textures.size(); ++i)
    tables.push_back({textures[i], i == of_opacity ? TableRole::opacity : TableRole::colour});
  return tables;
}

std::vector<FieldProbe::PlainTable> plain(std::span<const Table> tables, const std::array<float, 3>& colour,
                                          float opacity) {
  std::vector<FieldProbe::PlainTable> shown;
  for (const Table& table : tables) {
    const auto& [r, g, b] = colour;
    Rgba texel{r, g, b, opacity};
    if (table.role == TableRole::colour) texel[3] = 1;
    if (table.role == TableRole::opacity) texel.fill(opacity);
    shown.push_back({table.texture, texel});
  }
  return shown;
}

/// Returns what the ray shows under the tables, over constant fields of these values.
std::vector<Rgba> under(FieldProbe& probe, const LitRay& ray, const std::vector<FieldProbe::PlainTable>& tables,
                        std::span<const float> values) {
  for (const FieldProbe::PlainTable& table : tables) probe.show_plain(table);
  std::vector<Rgba> shown = probe.at(ray.x, ray.y, values);
  for (const FieldProbe::PlainTable& table : tables) probe.show_own(table.texture);
  return shown;
}

/// Returns the table's opacity under which the ray lets about half of the light through; null if there is none.
std::optional<float> half_seen_opacity(FieldProbe& probe, const LitRay& ray, std::span<const Table> tables,
                                       float value) {
  constexpr float half = 0.6F;
  constexpr float farthest = 0.25F;
  std::optional<float> found;
  float least = farthest;
  for (const float opacity : {0.002F, 0.004F, 0.008F, 0.016F, 0.03F, 0.06F, 0.12F, 0.24F, 0.48F}) {
    const Rgba shown = under(probe, ray, plain(tables, plain_colours.front(), opacity), {&value, 1}).front();
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

/// Whether each of the colours is visible, and differs from all others.
bool are_told_apart(const std::vector<Rgba>& colours) {
  constexpr double darkest = 1e-3;
  constexpr double least = 0.1;  // of the brighter one
  for (const Rgba& one : colours) {
    if (!(double(brightest_channel(one)) > darkest)) return false;
    for (const Rgba& other : colours) {
      const Tint a = tint_of(one);
      const Tint b = tint_of(other);
      if (&one != &other && difference(a, b) < least * std::max(brightest({a}), brightest({b}))) return false;
    }
  }
  return true;
}

/// Returns the opacity of each of the ray's samples, which are alike.
double sample_opacity(const March& march, const LitRay& ray, double of_ray) {
  return 1 - std::pow(1 - of_ray, 1 / double(places_on_way(march.steps, ray.way.way).size()));
}

std::optional<RayUnderPlainTables> under_tables(const MarchContext& measured, FieldProbe& probe,
                                                const March& march, const LitRay& ray, std::size_t of_opacity) {
  const std::vector<Table> tables = tables_with(measured, of_opacity);
  if (tables.empty()) return std::nullopt;
  const float width = measured.range[1] - measured.range[0];
  std::vector<float> values;
  values.reserve(places_in_range.size());
  for (const float place : places_in_range) values.push_back(measured.range[0] + place * width);
  const auto opacity = half_seen_opacity(probe, ray, tables, values.front());
  if (!opacity) return std::nullopt;
  LitRay under_plain{ray.x, ray.y, ray.way};
  const bool already = premultiplied_already(measured, march);
  for (const std::array<float, 3>& colour : plain_colours) {
    under_plain.tables.push_back(plain(tables, colour, *opacity));
    const std::vector<Rgba> shown = under(probe, ray, under_plain.tables.back(), values);
    if (!are_one_colour(shown)) return std::nullopt;
    under_plain.values.push_back(values.front());
    under_plain.base.push_back(premultiplied(shown.front(), already));
  }
  if (!are_told_apart(under_plain.base)) return std::nullopt;
  under_plain.plain_opacity = sample_opacity(march, ray, double(under_plain.base.front()[3]));
  return RayUnderPlainTables{under_plain, {of_opacity, *opacity, under_plain.plain_opacity}};
}

}  // namespace

std::optional<RayUnderPlainTables> under_plain_tables(const MarchContext& measured, FieldProbe& probe,
                                                      const March& march, const LitRay& ray) {
  if (march.background) return std::nullopt;
  for (const std::size_t of_opacity : {std::size_t(1), std::size_t(0)}) {
    if (auto found = under_tables(measured, probe, march, ray, of_opacity)) return found;
  }
  return std::nullopt;
}

std::optional<LitRay> under_known_tables(const MarchContext& measured, FieldProbe& probe, const March& march,
                                         const LitRay& ray) {
  constexpr double half = 0.6;
  const PlainTables& known = *march.plain_tables;
  const std::vector<Table> tables = tables_with(measured, known.of_opacity);
  if (tables.empty()) return std::nullopt;
  // In another view, or with other steps, the ray has another number of samples.
  const double wanted = sample_opacity(march, ray, half);
  const auto opacity = float(std::min(0.9, double(known.opacity) * wanted / known.of_sample));
  LitRay plain_ray{ray.x, ray.y, ray.way};
  plain_ray.values = {measured.range[0] + places_in_range.front() * (measured.range[1] - measured.range[0])};
  plain_ray.tables = {plain(tables, plain_colours.front(), opacity)};
  const Rgba shown = under(probe, ray, plain_ray.tables.front(), plain_ray.values).front();
  if (!reached(shown)) return std::nullopt;
  plain_ray.base = {premultiplied(shown, premultiplied_already(measured, march))};
  if (!is_translucent(plain_ray.base.front())) return std::nullopt;
  plain_ray.plain_opacity = sample_opacity(march, ray, double(plain_ray.base.front()[3]));
  return plain_ray;
}

}  // namespace understudy::spu
