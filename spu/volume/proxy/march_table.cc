// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_table.h"

#include <cmath>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Multiples of 1/255 fall on entries.
constexpr int table_entries = 4 * 255 + 1;

}  // namespace

std::optional<Refusal> measure_table(const MarchContext& measured, FieldProbe& probe,
                                     const RaysThroughBox& rays, const volume::RaySteps& rule, March& march) {
  constexpr float opaque = 0.6F;
  constexpr float saturated = 0.97F;
  constexpr double most_samples_of_shortest = 8;
  const bool already = measured.run.pipeline().blending.premultiplied;
  std::vector<float> values;
  values.reserve(table_entries);
  for (int i = 0; i < table_entries; ++i)
    values.push_back(value_at(measured.range, double(i) / (table_entries - 1)));
  auto& entries = march.table.entries;
  entries.clear();
  std::vector<float> shortest;  // opacity of the shortest ray
  for (const double samples : {1.0, 6.0, 40.0}) {
    const double wanted = march.extreme ? 3.0 : samples - 0.5 + (rule.divided ? 0.5 : rule.first);
    const Ray ray = ray_of_length(rays, rule, wanted);
    const double n = march.extreme ? 1 : samples_of_length(rule, ray.length);
    if (entries.empty() && n < 1) return "no short ray is in view: the opacity of one sample cannot be told";
    const bool long_at_best = entries.empty() && n > most_samples_of_shortest;
    if (!entries.empty() && std::abs(n - samples) > samples / 2) continue;
    const auto fragments = probe.at(ray.x, ray.y, values);
    if (!finite(fragments)) return "the fragment stage gives colours that are not finite";
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const Rgba colour = premultiplied(fragments[i], already);
      const float seen = amount(march, colour);
      // Whatever more a sample had, a ray of many would look alike.
      if (long_at_best && seen > saturated)
        return "no short ray is in view: the opacity of one sample cannot be told";
      if (entries.size() <= i) {
        entries.push_back(march.extreme ? colour : sample_of(march, colour, n));
        shortest.push_back(seen);
      } else if (seen < opaque) {
        // An opacity that does not grow with the way is that floor.
        const bool grows = seen > shortest[i] + 1e-5F;
        entries[i] = grows ? sample_of(march, colour, n) : Rgba{0, 0, 0, march.sum ? 1.0F : 0.0F};
      }
    }
    if (march.extreme) break;
  }
  return std::nullopt;
}

}  // namespace understudy::spu
