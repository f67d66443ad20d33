// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_changes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/exit_steps.h"
#include "spu/volume/proxy/extreme_jitter.h"
#include "spu/volume/proxy/extreme_steps.h"
#include "spu/volume/proxy/facing_colours.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/gradient_opacity.h"
#include "spu/volume/proxy/headlight.h"
#include "spu/volume/proxy/march_table.h"
#include "spu/volume/proxy/mean_steps.h"
#include "spu/volume/proxy/opacity_limit.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/sample_places.h"
#include "spu/volume/proxy/shader_background.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Whether the samples of an extreme or of a mean lie where `march` places them; null if no field shows it.
std::optional<bool> samples_lie_as_said(const MarchContext& measured, const March& march, const ProxyBox& box) {
  FieldProbe probe(measured);
  if (!probe.complete()) return std::nullopt;
  if (march.extreme) {
    const auto ends = [&] { return ends_of_rays(measured, probe, march.table, box); };
    if (march.jitter && !begin_as_said(march.steps, ends())) return false;
    if (!held_still(measured, probe, march)) return false;
    volume::RaySteps steps = march.steps;
    steps.offsets.reset();
    const std::vector<RayEnds> still = ends();
    if (still.empty()) return std::nullopt;
    return lie_on(steps, still);
  }
  const std::vector<float> values = values_over(measured.range);
  const auto middle = RaysThroughBox(box.camera.texture_to_clip, box.region, box.cuts).middle();
  const auto counted =
      counted_by_means(probe, box, *march.mean, values, probe.at(middle[0], middle[1], values));
  if (counted.empty()) return std::nullopt;
  return have_as_many(counted, march.steps);
}

/// Returns what the ray through the middle shows of the field of each value, according to `march`; no fragments
/// if that ray misses the box.
std::vector<Rgba> predicted_rays(const March& march, const RaysThroughBox& rays,
                                 const std::vector<float>& values) {
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  std::vector<Rgba> predicted;
  for (const float value : values) {
    predicted.push_back(way ? ray_of(march, even_sample(march, value),
                                     samples_of_length(march.steps, steps_of_way(march.steps, *way)))
                            : Rgba{0, 0, 0, no_fragment});
  }
  return predicted;
}

}  // namespace

std::optional<March> with_new_table(const MarchContext& measured, const March& march, const ProxyBox& box) {
  if (march.alpha_twice && !multiplies_by_alpha(measured.run.pipeline())) return std::nullopt;
  March changed = march;
  changed.table.low = measured.range[0];
  changed.table.high = measured.range[1];
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  {
    FieldProbe probe(measured);
    if (!probe.complete() || !held_still(measured, probe, march)) return std::nullopt;
    if (march.background) {
      changed.background = remove_background(measured, probe, rays);
      if (!changed.background) return std::nullopt;
    }
    if (measure_table(measured, probe, rays, march.steps, changed)) return std::nullopt;
    if (is_black_where_even(march) && !take_facing_colours(measured, probe, box, changed)) return std::nullopt;
    take_opacity_limit(measured, march.steps, probe, rays, changed);
    if (!fill_unseen(probe, box, march.steps, changed)) return std::nullopt;
  }
  if (fades_by_gradient(march)) {
    auto opacity = with_new_factors(measured, march);
    if (!opacity) return std::nullopt;
    changed.light->gradient_opacity = *std::move(opacity);
  }
  if (march.jitter) {
    changed.steps.offsets = ray_offsets(measured.context, measured.run, *march.jitter);
    if (!changed.steps.offsets) return std::nullopt;
  }
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  if (!way) return std::nullopt;
  if (!march.shows_one_colour()) {
    const auto value = half_seen_value(changed, *way);
    if (!value) return std::nullopt;
    changed.translucent = *value;
  }
  if (!still_marches(measured, changed, box, {.values = 16})) return std::nullopt;
  return changed;
}

std::variant<March, Refusal> with_new_steps(const MarchContext& measured, const March& march,
                                            const ProxyBox& box) {
  March changed = march;
  changed.from_inside = true;
  if (march.shows_one_colour()) return changed;  // its steps can be measured from outside only
  FieldProbe probe(measured);
  if (!probe.complete() || !held_still(measured, probe, march))
    return "the driver offers no float framebuffer to probe with";
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  if (!remove_known_background(measured, probe, rays, march))
    return "the steps of rays are others where the eye is inside";
  const auto counted = counted_rays(measured, probe, rays, march);
  if (const auto* reason = std::get_if<std::string>(&counted)) return *reason;
  const auto& metric = march.steps.metric;
  const std::array spaces{volume::Vec3{volume::length({metric[0], metric[3], metric[6]}),
                                       volume::length({metric[1], metric[4], metric[7]}),
                                       volume::length({metric[2], metric[5], metric[8]})},
                          axes_in_texels(measured.texture.size)};
  for (const StepFit& fit : fit_steps(std::get<std::vector<CountedRay>>(counted), spaces)) {
    const volume::RaySteps rule = rules_of(fit).front();
    if (fit.unexplained > most_unexplained || rule.first != counted_from(march.steps)) continue;
    changed.steps.metric = rule.metric;
    changed.alike_metrics.clear();
    return changed;
  }
  return "the steps of rays are others where the eye is inside";
}

std::optional<March> with_longer_steps(const MarchContext& measured, const March& march, const ProxyBox& box,
                                       double factor, double offset) {
  // Other values in every frame, as the table is not measured again.
  const RaysLookedAt looked_at{.values = 16, .offset = offset};
  if (march.sum || march.steps.divided) return std::nullopt;
  March longer = march;
  for (double& number : longer.steps.metric) number /= factor;
  if (march.shows_one_colour()) {
    // Rays through constant fields look alike whatever the number of their samples.
    longer.steps_seen = samples_lie_as_said(measured, longer, box).value_or(false);
    if (!longer.steps_seen || !still_marches(measured, longer, box, looked_at)) return std::nullopt;
    return longer;
  }
  March corrected = longer;
  for (Rgba& entry : corrected.table.entries) entry = ray_of(march, entry, factor);
  for (const March& candidate : {corrected, longer}) {
    if (still_marches(measured, candidate, box, looked_at)) return candidate;
  }
  return std::nullopt;
}

bool still_marches(const MarchContext& measured, const March& march, const ProxyBox& box,
                   const RaysLookedAt& looked_at) {
  constexpr float same_colour = 5e-3F;
  FieldProbe probe(measured);
  if (!probe.complete() || !held_still(measured, probe, march)) return false;
  const bool already = premultiplied_already(measured, march);
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  std::vector<float> values;
  values.reserve(std::size_t(looked_at.values));
  // Values of entries: between two of them, colours may have a corner that the measured table lacks.
  const double last_entry = double(march.table.entries.size()) - 1;
  for (int i = 0; i < looked_at.values; ++i) {
    const double entry = std::round((i + looked_at.offset) / looked_at.values * last_entry);
    values.push_back(value_at({march.table.low, march.table.high}, entry / last_entry));
  }
  const auto expected = [&](const Rgba& fragment, float value, double n) {
    const Rgba sample = even_sample(march, value);
    const Rgba got = premultiplied(fragment, already);
    if (march.shows_one_colour()) return largest_difference(got, sample) <= same_colour;
    // A ray whose end falls on a sample may have one more or less.
    for (const double count : {n, n - 1, n + 1}) {
      if (count < 1) continue;
      const Rgba ray = ray_of(march, sample, count);
      const Rgba shown = march.background ? over_background(*march.background, ray) : ray;
      if (largest_difference(got, shown) <= same_colour) return true;
    }
    return false;
  };
  const auto shows_table = [&](const Ray& ray) {
    const double samples = march.shows_one_colour() ? 1 : samples_of_length(march.steps, ray.length);
    const auto fragments = probe.at(ray.x, ray.y, values);
    if (!march.background && !only_nearest_shows(measured, probe, ray, values, fragments)) return false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!expected(fragments[i], values[i], samples)) return false;
    }
    return true;
  };
  // At the box's silhouette, where short rays are, one may just miss its pixel, or a sample. Two rays that
  // agree cannot both have one sample less, of a value that is denser by just that much.
  constexpr std::array short_lengths{2.5, 4.5, 7.5, 3.5};
  const std::ptrdiff_t enough = march.shows_one_colour() ? 1 : 2;
  const double first = march.steps.divided ? 0.5 : counted_from(march.steps);
  std::ptrdiff_t agreeing = 0;
  for (const double length : short_lengths) {
    if (looked_at.values == 0 || agreeing == enough) break;
    agreeing +=
        shows_table(ray_of_length(rays, march.steps, march.shows_one_colour() ? length + 1 : length + first))
            ? 1
            : 0;
  }
  if (looked_at.values > 0 && agreeing < enough) return false;
  if (looked_at.light && march.light && !still_lit(measured, probe, box, march)) return false;
  // Under the white table, no other check shows that gradient opacity has been turned on or off.
  if (fades_by_gradient(march) == measured.tables_of_gradients.empty()) return false;
  if (looked_at.light && fades_by_gradient(march) && !still_fades_by_gradient(measured, probe, box, march))
    return false;
  if (is_black_where_even(march) && !values.empty() &&
      !shows_facing_colours(measured, probe, box, march, values))
    return false;
  if (march.shows_one_colour() || !looked_at.long_ray) return true;
  // A long ray as well: steps may have another length in its direction.
  const auto middle = rays.middle();
  const int column = probe.column_at(middle[0]);
  const int row = probe.row_at(middle[1]);
  const auto way = rays.way(probe.x_of(column), probe.y_of(row));
  if (!way) return true;
  return expected(probe.pixel(column, row, march.translucent), march.translucent,
                  samples_of_length(march.steps, steps_of_way(march.steps, *way)));
}

bool still_placed(const MarchContext& measured, const March& march, const ProxyBox& box,
                  const PlacesLookedAt& looked_at) {
  if (march.light && !looked_at.axes_of_gradients.empty() &&
      !gradients_still_reach(measured, box, march, looked_at.axes_of_gradients))
    return false;
  if (!looked_at.samples || !box.cuts.empty()) return true;
  if (march.shows_one_colour())
    return !march.steps_seen || samples_lie_as_said(measured, march, box).value_or(true);
  FieldProbe probe(measured);
  if (!probe.complete()) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region);
  if (!remove_known_background(measured, probe, rays, march)) return false;
  std::vector<float> values = values_over(measured.range, looked_at.values);
  values.push_back(march.translucent);
  const auto middle = rays.middle();
  // Colours without the shader's background are known of rays that were drawn only.
  const auto seen =
      seen_values(values, looked_at.predicted && !march.background ? predicted_rays(march, rays, values)
                                                                   : probe.at(middle[0], middle[1], values));
  SplitBands bands = looked_at.bands;
  bands.across_all_axes = march.space.of_whole_box || march.steps.counted_from;
  const auto split = split_rays(measured, probe, march, box, seen, bands);
  const volume::RaySteps placed = march.from_exit ? counted_from_exit(march.steps, rays, probe) : march.steps;
  return misplaced_part(split, rays, placed).value_or(0) <= most_misplaced;
}

}  // namespace understudy::spu
