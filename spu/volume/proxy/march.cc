// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/exit_steps.h"
#include "spu/volume/proxy/extreme_steps.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march_table.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/sample_places.h"
#include "spu/volume/proxy/shader_background.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Whether the samples of an extreme lie where `march` says; empty where no field tells.
std::optional<bool> extreme_lies_as_said(const MarchContext& measured, const March& march,
                                         const ProxyBox& box) {
  FieldProbe probe(measured.context, measured.run, measured.texture, measured.surfaces);
  if (!probe.complete()) return std::nullopt;
  return extremes_lie_on(march.steps, measured, probe, march.table, box);
}

/// For an extreme value, which does not tell how many samples it was taken of: one or two a texel, or one for
/// each length of the shortest ray that has any.
std::vector<volume::RaySteps> rules_for_extremes(const std::array<int, 3>& size, double shortest) {
  constexpr double none = 0.02;  // of a texel
  std::vector<volume::RaySteps> rules;
  const auto add = [&](double density) {
    volume::RaySteps steps;
    for (std::size_t k = 0; k < 3; ++k) steps.metric[4 * k] = density * size[k];
    steps.first = shortest < none ? 0 : shortest * density;
    rules.push_back(steps);
  };
  add(1);
  add(2);
  if (shortest > 0.25 && shortest < 2) add(1 / shortest);
  return rules;
}

constexpr int values_tried = 128;

const Refusal samples_lie_elsewhere{
    "samples do not lie on constant steps from the box's faces (jitter, cropping)"};

/// Whether blending multiplies colours by alpha, after they are clamped.
bool multiplies_by_alpha(const Pipeline& pipeline) {
  return !pipeline.blending.premultiplied && !pipeline.target.floating;
}

/// Whether fragments of this alpha leave the program's own colour and nothing of what was there before.
bool hides_what_was_there(const Pipeline& pipeline, float alpha) {
  constexpr float opaque = 1 - 1e-6F;
  const Blending& blending = pipeline.blending;
  if (blending.replaces) return true;
  return alpha >= opaque && alpha <= 1 && blending.op == volume::Operator::over &&
         blending.front_to_back == FrontToBack::no &&
         (blending.alpha.untouched ? pipeline.target.alpha_bits == 0
                                   : blending.alpha.op == volume::Operator::over);
}

/// Shows `probe` the rays without the background that the program puts them over. Null: it does no such thing.
std::optional<ShaderBackground> removed_background(const MarchContext& measured, FieldProbe& probe,
                                                   const RaysThroughBox& rays,
                                                   const std::vector<float>& values) {
  volume::RaySteps texels;
  for (std::size_t k = 0; k < 3; ++k) texels.metric[4 * k] = measured.texture.size[k];
  auto found = find_background(probe, rays, texels, values);
  if (!found || !hides_what_was_there(measured.run.pipeline(), found->background.alpha)) return std::nullopt;
  probe.remove(found->background, std::move(found->rays));
  return found->background;
}

/// `count` values all over the range.
std::vector<float> values_over(const std::array<float, 2>& range, int count) {
  std::vector<float> values;
  values.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) values.push_back(value_at(range, double(i) / (count - 1)));
  return values;
}

/// As it was found before; false where it is another now.
bool removes_background(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                        const March& march) {
  if (!march.background) return true;
  constexpr double same = 1e-3;
  const auto found = removed_background(measured, probe, rays, values_over(measured.range, values_tried));
  return found && volume::length(volume::subtract(found->colour, march.background->colour)) < same;
}

/// Counted from where the rays leave the box, all over the application's viewport.
volume::RaySteps from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays, const FieldProbe& probe) {
  const volume::Rect viewport{probe.left(), probe.bottom(), probe.width(), probe.height()};
  return counted_from_exit(steps, rays, viewport, viewport);
}

constexpr const char* back_faces_show = "rays that begin at the back faces of the box show something, too";

/// Whether all fragments of a ray add up to the nearest one: if faces are not culled, the front and the back
/// fragment are blended. Where fragments replace what is there, the nearest one is left (RayCasterStage).
bool only_nearest_shows(const MarchContext& measured, FieldProbe& probe, const Ray& ray,
                        const std::vector<float>& values, const std::vector<Rgba>& nearest) {
  if (measured.run.pipeline().blending.replaces) return true;
  const auto sums = probe.sums_at(ray.x, ray.y, values);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!(largest_difference(sums[i], reached(nearest[i]) ? nearest[i] : Rgba{}) <= 1e-6F)) return false;
  }
  return true;
}

/// One measurement, from the composition of samples to their places and colours. Each step fills in its part of
/// the march, or says why there is none.
class MarchMeasurement {
 public:
  MarchMeasurement(const MarchContext& measured, const ProxyBox& box)
      : measured_(measured),
        box_(box),
        probe_(measured.context, measured.run, measured.texture, measured.surfaces),
        rays_(box.camera.texture_to_clip, box.region, box.cuts) {
    for (std::size_t k = 0; k < 3; ++k) texels_.metric[4 * k] = measured.texture.size[k];
    march_.clipped = measured.clipped;
    march_.from_inside = !box.cuts.empty();
  }

  std::optional<Refusal> measure();
  /// Every way to read what was measured, in the spaces whose boxes are known.
  MarchFinding marches(const std::vector<CoordinateSpace>& spaces,
                       const std::vector<std::optional<ProxyBox>>& boxes) const;

 private:
  std::optional<Refusal> find_composition();
  std::optional<Refusal> find_translucent_value();
  void find_shown_everywhere();
  double shortest_with_sample();
  std::optional<Refusal> find_steps();
  void take_rules(const std::vector<StepFit>& fits);
  std::optional<Refusal> take_offsets();
  std::optional<Refusal> find_places();
  void add_marches(const CoordinateSpace& space, const volume::RaySteps& rule, bool seen,
                   std::vector<March>& marches) const;

  const MarchContext& measured_;
  const ProxyBox& box_;
  FieldProbe probe_;
  RaysThroughBox rays_;
  volume::RaySteps texels_;    ///< steps of one texel
  std::vector<float> values_;  ///< all over the range
  std::vector<Rgba> through_;  ///< their colours on a ray through the middle
  March march_;
  std::vector<volume::RaySteps> rules_;
  std::size_t extremes_seen_ =
      0;  ///< so many first ones of `rules_` were seen of an extreme, in the first space
  std::vector<SplitRays> split_;
};

std::optional<Refusal> MarchMeasurement::find_composition() {
  values_ = values_over(measured_.range, values_tried);
  const auto middle = rays_.middle();
  through_ = probe_.at(middle[0], middle[1], values_);
  const Ray brief = ray_of_length(rays_, texels_, 3);
  const auto briefly = probe_.at(brief.x, brief.y, values_);
  if (!finite(through_) || !finite(briefly)) return "the fragment stage gives colours that are not finite";
  const Blending& blending = measured_.run.pipeline().blending;
  if (!probe_.culls_faces() &&
      (blending.op == volume::Operator::min || blending.alpha.op == volume::Operator::min))
    return "front and back faces of the box are drawn under a minimum";
  // Whatever the way through it, one value has one colour: samples are not composed.
  march_.extreme = volume::Operator::max;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (!(largest_difference(through_[i], briefly[i]) <= 2e-3F)) march_.extreme.reset();
  }
  if (!march_.extreme && one_alpha(through_, briefly))
    march_.background = removed_background(measured_, probe_, rays_, values_);
  // Which face's fragment an opaque one is left of, RayCasterStage looks at.
  if (!march_.background && !only_nearest_shows(measured_, probe_, {middle[0], middle[1]}, values_, through_))
    return back_faces_show;
  if (march_.background) {
    through_ = probe_.at(middle[0], middle[1], values_);
  } else if (!march_.extreme) {
    march_.sum = plain_sum(through_, briefly);
  }
  march_.alpha_twice = !march_.extreme && !march_.sum && !march_.background &&
                       multiplies_by_alpha(measured_.run.pipeline()) && grow_with_alpha(through_, briefly);
  const auto way = rays_.way(middle[0], middle[1]);
  if (march_.extreme && (!way || steps_of_way(texels_, *way) < 2 * brief.length))
    return "rays of one length alone do not tell the step";
  return std::nullopt;
}

std::optional<Refusal> MarchMeasurement::find_translucent_value() {
  const auto middle = rays_.middle();
  TranslucentRay found{{middle[0], middle[1]}, values_[values_.size() / 2]};
  if (!march_.extreme) {
    const auto translucent = translucent_ray(measured_, probe_, rays_, texels_, march_, values_);
    if (!translucent) return "no value is translucent on any ray: samples cannot be counted";
    found = *translucent;
  }
  if (depends_on_gradient(measured_, probe_, found.ray, found.value))
    return "the colour depends on the gradient (lighting)";
  march_.translucent = found.value;
  return std::nullopt;
}

void MarchMeasurement::find_shown_everywhere() {
  if (!march_.sum) return;
  constexpr double none = 0.02;  // of a texel
  const auto dark = std::find_if(through_.begin(), through_.end(),
                                 [](const Rgba& ray) { return brightest_channel(ray) == 0; });
  if (dark == through_.end()) return;
  const float value = values_[std::size_t(dark - through_.begin())];
  march_.sum->everywhere = shortest_seen(probe_, rays_, texels_, value, *dark) < none;
}

double MarchMeasurement::shortest_with_sample() {
  const auto brightest = std::max_element(through_.begin(), through_.end(),
                                          [](const Rgba& a, const Rgba& b) { return a[3] < b[3]; });
  if (!((*brightest)[3] > 0)) return 0;
  return shortest_seen(probe_, rays_, texels_, values_[std::size_t(brightest - through_.begin())], *brightest);
}

std::optional<Refusal> MarchMeasurement::find_steps() {
  const auto& size = measured_.texture.size;
  if (march_.extreme) {
    rules_ = rules_for_extremes(size, shortest_with_sample());
    return std::nullopt;
  }
  const auto count = [&] { return counted_rays(measured_, probe_, rays_, march_); };
  const auto counted = count();
  if (const auto* reason = std::get_if<std::string>(&counted)) return Refusal{*reason};
  const auto& all = std::get<std::vector<CountedRay>>(counted);
  auto fits = fit_steps(all, axes_in_texels(size));
  if (fits.empty()) return "too few rays of several samples are in view to tell the step";
  if (fits.front().unexplained > most_unexplained) {
    auto finding = find_jitter(measured_.context, measured_.run, probe_, count, all, size);
    if (!finding) return samples_lie_elsewhere;
    march_.jitter = finding->jitter;
    fits = std::move(finding->fits);
  }
  take_rules(fits);
  return std::nullopt;
}

void MarchMeasurement::take_rules(const std::vector<StepFit>& fits) {
  for (const StepFit& fit : fits) {
    std::vector<volume::RaySteps> of_fit = rules_of(fit);
    // A way in equal parts has as many wherever the first one begins.
    if (march_.jitter || measured_.clipped || !box_.cuts.empty()) of_fit.resize(1);
    rules_.insert(rules_.end(), of_fit.begin(), of_fit.end());
  }
}

std::optional<Refusal> MarchMeasurement::take_offsets() {
  if (!march_.jitter) return std::nullopt;
  const auto offsets = ray_offsets(measured_.context, measured_.run, *march_.jitter);
  if (!offsets) return "the texture of noise at the rays' beginnings cannot be read back";
  for (volume::RaySteps& rule : rules_) {
    rule.offsets = offsets;
    rule.counted_without_offsets = march_.jitter->moves_only;
  }
  return std::nullopt;
}

std::optional<Refusal> MarchMeasurement::measure() {
  if (!probe_.complete()) return "the driver offers no float framebuffer to probe with";
  if (auto refusal = find_composition()) return refusal;
  if (auto refusal = find_translucent_value()) return refusal;
  find_shown_everywhere();
  if (auto refusal = find_steps()) return refusal;
  march_.table.low = measured_.range[0];
  march_.table.high = measured_.range[1];
  if (auto refusal = measure_table(measured_, probe_, rays_, rules_.front(), march_)) return refusal;
  if (!fill_unseen(probe_, box_, rules_.front(), march_))
    return "a value that hides what lies behind it has the colour of the shader's background";
  if (auto refusal = take_offsets()) return refusal;
  return find_places();
}

std::optional<Refusal> MarchMeasurement::find_places() {
  if (march_.extreme) {
    const auto steps = extreme_steps(measured_, probe_, march_.table, box_);
    extremes_seen_ = steps.size();
    rules_.insert(rules_.begin(), steps.begin(), steps.end());
    return std::nullopt;
  }
  // Where the eye is inside, rays of all directions begin at one place.
  if (!box_.cuts.empty()) return std::nullopt;
  if (march_.jitter && !show_own_noise(measured_.run, probe_, *march_.jitter)) return std::nullopt;
  const std::vector<SeenValue> seen = seen_values(values_, through_);
  const auto split = [&] { return split_rays(measured_, probe_, march_, box_, seen); };
  split_ = split();
  const bool explained = std::ranges::any_of(rules_, [&](const volume::RaySteps& rule) {
    return misplaced_part(split_, rays_, rule) <= most_misplaced;
  });
  if (explained || march_.jitter) return std::nullopt;
  march_.from_exit = std::ranges::any_of(rules_, [&](const volume::RaySteps& rule) {
    return !rule.divided && misplaced_part(split_, rays_, from_exit(rule, rays_, probe_)) <= most_misplaced;
  });
  if (march_.from_exit) return std::nullopt;
  march_.jitter = find_moving_jitter(measured_.context, measured_.run, probe_, split, rays_, rules_);
  return take_offsets();
}

void MarchMeasurement::add_marches(const CoordinateSpace& space, const volume::RaySteps& rule, bool seen,
                                   std::vector<March>& marches) const {
  March march = march_;
  march.space = space;
  march.steps = rule;
  march.steps_seen = seen;
  // The step that reaches the opaque geometry is usually taken before it is noticed.
  march.steps.past_depth = measured_.ends_at_geometry ? 1 : 0;
  // Planes end rays as opaque geometry does; where no ray leaves by one, both images are alike.
  for (const double past_planes : {march.steps.past_depth, 1 - march.steps.past_depth}) {
    if (!measured_.clipped && past_planes != march.steps.past_depth) continue;
    march.past_planes = past_planes;
    marches.push_back(march);
    // Fields of one value do not tell which extreme it is.
    if (!march.extreme) continue;
    marches.push_back(march);
    marches.back().extreme = volume::Operator::min;
  }
}

MarchFinding MarchMeasurement::marches(const std::vector<CoordinateSpace>& spaces,
                                       const std::vector<std::optional<ProxyBox>>& boxes) const {
  std::vector<March> marches;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (!boxes[i]) continue;
    const RaysThroughBox rays(boxes[i]->camera.texture_to_clip, boxes[i]->region, boxes[i]->cuts);
    for (std::size_t r = 0; r < rules_.size(); ++r) {
      const bool seen = !march_.extreme || (i == 0 && r < extremes_seen_);
      if (march_.from_exit && rules_[r].divided) continue;
      const volume::RaySteps placed = march_.from_exit ? from_exit(rules_[r], rays, probe_) : rules_[r];
      if (misplaced_part(split_, rays, placed) <= most_misplaced)
        add_marches(spaces[i], rules_[r], seen, marches);
    }
  }
  if (marches.empty()) return samples_lie_elsewhere;
  return marches;
}

}  // namespace

MarchFinding measure_march(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces,
                           const ProxyBox& box) {
  if (measured.texture.base == BaseFormat::rgba) return "a ray caster over a texture of colours";
  std::vector<std::optional<ProxyBox>> boxes;
  boxes.reserve(spaces.size());
  for (const CoordinateSpace& space : spaces) boxes.push_back(proxy_box(measured, space));
  MarchMeasurement measurement(measured, box);
  if (auto refusal = measurement.measure()) return *std::move(refusal);
  return measurement.marches(spaces, boxes);
}

std::optional<March> with_new_table(const MarchContext& measured, const March& march, const ProxyBox& box) {
  if (march.alpha_twice && !multiplies_by_alpha(measured.run.pipeline())) return std::nullopt;
  March changed = march;
  changed.table.low = measured.range[0];
  changed.table.high = measured.range[1];
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  {
    FieldProbe probe(measured.context, measured.run, measured.texture, measured.surfaces);
    if (!probe.complete() || !held_still(measured, probe, march)) return std::nullopt;
    if (march.background) {
      changed.background = removed_background(measured, probe, rays, values_over(measured.range, values_tried));
      if (!changed.background) return std::nullopt;
    }
    if (measure_table(measured, probe, rays, march.steps, changed)) return std::nullopt;
    if (!fill_unseen(probe, box, march.steps, changed)) return std::nullopt;
  }
  if (march.jitter) {
    changed.steps.offsets = ray_offsets(measured.context, measured.run, *march.jitter);
    if (!changed.steps.offsets) return std::nullopt;
  }
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  if (!way) return std::nullopt;
  float nearest = 0.48F;
  const auto& table = changed.table;
  for (std::size_t i = 0; i < table.entries.size() && !march.extreme; ++i) {
    const float through = amount(march, ray_of(march, table.entries[i], steps_of_way(march.steps, *way)));
    if (std::abs(through - 0.5F) >= nearest) continue;
    nearest = std::abs(through - 0.5F);
    changed.translucent = value_at(measured.range, double(i) / double(table.entries.size() - 1));
  }
  if ((nearest == 0.48F && !march.extreme) || !still_marches(measured, changed, box, {.values = 16}))
    return std::nullopt;
  return changed;
}

std::variant<March, Refusal> with_new_steps(const MarchContext& measured, const March& march,
                                            const ProxyBox& box) {
  March changed = march;
  changed.from_inside = true;
  if (march.extreme) return changed;  // whose steps only rays from outside tell
  FieldProbe probe(measured.context, measured.run, measured.texture, measured.surfaces);
  if (!probe.complete() || !held_still(measured, probe, march))
    return "the driver offers no float framebuffer to probe with";
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  if (!removes_background(measured, probe, rays, march)) return samples_lie_elsewhere;
  const auto counted = counted_rays(measured, probe, rays, march);
  if (const auto* reason = std::get_if<std::string>(&counted)) return *reason;
  const volume::Vec3 axes = axes_in_texels(measured.texture.size);
  for (const StepFit& fit : fit_steps(std::get<std::vector<CountedRay>>(counted), axes)) {
    const volume::RaySteps rule = rules_of(fit).front();
    if (fit.unexplained > most_unexplained || rule.first != march.steps.first) continue;
    changed.steps.metric = rule.metric;
    return changed;
  }
  return "the steps of rays are others where the eye is inside";
}

std::optional<March> with_longer_steps(const MarchContext& measured, const March& march, const ProxyBox& box,
                                       double factor) {
  // The table is not measured otherwise.
  constexpr RaysLookedAt looked_at{.values = 64};
  if (march.sum || march.steps.divided) return std::nullopt;
  March longer = march;
  for (double& number : longer.steps.metric) number /= factor;
  if (march.extreme) {
    // Its rays look alike whatever the number of their samples.
    longer.steps_seen = extreme_lies_as_said(measured, longer, box).value_or(false);
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
  FieldProbe probe(measured.context, measured.run, measured.texture, measured.surfaces);
  if (!probe.complete() || !held_still(measured, probe, march)) return false;
  const bool already = premultiplied_already(measured, march);
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  std::vector<float> values;
  values.reserve(std::size_t(looked_at.values));
  for (int i = 0; i < looked_at.values; ++i)
    values.push_back(value_at({march.table.low, march.table.high}, (i + looked_at.offset) / looked_at.values));
  const auto expected = [&](const Rgba& fragment, float value, double n) {
    const Rgba sample = table_at(march.table, value);
    const Rgba got = premultiplied(fragment, already);
    if (march.extreme) return largest_difference(got, sample) <= same_colour;
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
    const double samples = march.extreme ? 1 : samples_of_length(march.steps, ray.length);
    const auto fragments = probe.at(ray.x, ray.y, values);
    if (!march.background && !only_nearest_shows(measured, probe, ray, values, fragments)) return false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!expected(fragments[i], values[i], samples)) return false;
    }
    return true;
  };
  // At the box's silhouette, where short rays are, one may just miss its pixel, or a sample.
  constexpr std::array short_lengths{2.5, 4.5, 7.5};
  const double first = march.steps.divided ? 0.5 : march.steps.first;
  if (looked_at.values > 0 && std::ranges::none_of(short_lengths, [&](double length) {
        return shows_table(ray_of_length(rays, march.steps, march.extreme ? length + 1 : length + first));
      }))
    return false;
  if (march.extreme || !looked_at.long_ray) return true;
  // A long ray: its step may have another length in another direction.
  const auto middle = rays.middle();
  const int column = std::clamp(int((middle[0] + 1) / 2 * probe.width()), 0, probe.width() - 1);
  const int row = std::clamp(int((middle[1] + 1) / 2 * probe.height()), 0, probe.height() - 1);
  const auto way = rays.way(2 * (column + 0.5) / probe.width() - 1, 2 * (row + 0.5) / probe.height() - 1);
  if (!way) return true;
  return expected(probe.pixel(column, row, march.translucent), march.translucent,
                  samples_of_length(march.steps, steps_of_way(march.steps, *way)));
}

bool still_placed(const MarchContext& measured, const March& march, const ProxyBox& box) {
  constexpr int tried = 32;
  if (!box.cuts.empty()) return true;
  if (march.extreme) return !march.steps_seen || extreme_lies_as_said(measured, march, box).value_or(true);
  FieldProbe probe(measured.context, measured.run, measured.texture, measured.surfaces);
  if (!probe.complete()) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region);
  if (!removes_background(measured, probe, rays, march)) return false;
  std::vector<float> values = values_over(measured.range, tried);
  values.push_back(march.translucent);
  const auto middle = rays.middle();
  const auto split =
      split_rays(measured, probe, march, box, seen_values(values, probe.at(middle[0], middle[1], values)));
  const volume::RaySteps placed = march.from_exit ? from_exit(march.steps, rays, probe) : march.steps;
  return misplaced_part(split, rays, placed) <= most_misplaced;
}

}  // namespace understudy::spu
