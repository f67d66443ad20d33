// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "spu/volume/classification/sample_rounding.h"
#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/exit_steps.h"
#include "spu/volume/proxy/extreme_jitter.h"
#include "spu/volume/proxy/extreme_steps.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/first_sample.h"
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
#include "spu/volume/proxy/step_spaces.h"
#include "volume/cell_lattice.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Returns likely rules for an extreme value, which does not show how many samples it was taken of: one or two
/// per texel, or one per length of the shortest ray that has any.
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

const Refusal samples_lie_elsewhere{
    "samples do not lie on constant steps from the box's faces (jitter, cropping)"};

constexpr const char* back_faces_show = "rays that begin at the back faces of the box show something, too";

/// One measurement, from the composition of samples to their positions and colours. Each step fills in its part
/// of the march, or returns why there is none.
class MarchMeasurement {
 public:
  MarchMeasurement(const MarchContext& measured, const ProxyBox& box)
      : measured_(measured),
        box_(box),
        probe_(measured),
        rays_(box.camera.texture_to_clip, box.region, box.cuts) {
    for (std::size_t k = 0; k < 3; ++k) texels_.metric[4 * k] = measured.texture.size[k];
    march_.clipped = measured.clipped;
    march_.from_inside = !box.cuts.empty();
  }

  /// Measures all but the light.
  std::optional<Refusal> measure_samples();
  std::optional<Refusal> measure_light();
  /// Returns all interpretations of what was measured, in the spaces whose boxes are known.
  MarchFinding marches(const std::vector<CoordinateSpace>& spaces,
                       const std::vector<std::optional<ProxyBox>>& boxes) const;

 private:
  std::optional<Refusal> find_composition();
  std::optional<Refusal> find_translucent_value();
  void find_alpha_of_shortest_rays();
  double shortest_with_sample();
  std::optional<Refusal> find_steps();
  std::optional<Refusal> find_steps_of_mean();
  void take_rules(const std::vector<StepFit>& fits);
  std::optional<Refusal> take_offsets();
  std::optional<Refusal> find_places();
  std::optional<Refusal> find_places_of_extremes();
  void find_first_samples();
  /// Returns the fraction of rays whose samples are not where a rule puts them, counted from where rays enter
  /// or leave the box; null if it cannot be counted so.
  std::optional<double> misplaced(const volume::RaySteps& rule, bool from_exit) const;
  /// Likewise for the rule that explains most rays.
  double least_misplaced(bool from_exit) const;
  const volume::RaySteps& likeliest_rule() const;
  /// Whether nodes can render samples that are counted ahead in such a box.
  bool may_count_ahead(const volume::RaySteps& rule, const volume::Box& region) const;
  void add_lit_marches(March march, std::vector<March>& marches) const;
  void add_marches(const CoordinateSpace& space, const volume::Box& region, const volume::RaySteps& rule,
                   bool seen, std::vector<March>& marches) const;

  const MarchContext& measured_;
  const ProxyBox& box_;
  FieldProbe probe_;
  RaysThroughBox rays_;
  volume::RaySteps texels_;    ///< steps of one texel
  std::vector<float> values_;  ///< spread over the range
  std::vector<Rgba> through_;  ///< their colours on a ray through the middle
  March march_;
  bool lit_ = false;                   ///< whether slopes have another colour than constant fields
  std::vector<volume::Light> lights_;  ///< any of which may be the program's
  std::vector<volume::RaySteps> rules_;
  std::vector<std::array<double, 9>> metrics_;  ///< of all fits, which explain the same counts
  std::size_t extremes_seen_ = 0;  ///< number of leading `rules_` confirmed for an extreme, in the first space
  std::vector<SplitRays> split_;
};

std::optional<Refusal> MarchMeasurement::find_composition() {
  values_ = values_over(measured_.range);
  const auto middle = rays_.middle();
  through_ = probe_.at(middle[0], middle[1], values_);
  const Ray brief = ray_of_length(rays_, texels_, 3);
  const auto briefly = probe_.at(brief.x, brief.y, values_);
  if (!finite(through_) || !finite(briefly)) return "the fragment stage gives colours that are not finite";
  const Blending& blending = measured_.run.pipeline().blending;
  if (!probe_.culls_faces() &&
      (blending.op == volume::Operator::min || blending.alpha.op == volume::Operator::min))
    return "front and back faces of the box are drawn under a minimum";
  // If one value has one colour, whatever the length of its path, samples are not composed.
  march_.extreme = volume::Operator::max;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (!(largest_difference(through_[i], briefly[i]) <= 2e-3F)) march_.extreme.reset();
  }
  // A few nearly opaque samples look like any number of them: remove_background() tries shorter rays.
  if (one_alpha(through_, briefly)) march_.background = remove_background(measured_, probe_, rays_);
  if (march_.background) march_.extreme.reset();
  if (march_.extreme && shows_mean(probe_, box_, values_, through_)) {
    march_.extreme.reset();
    march_.mean = one_alpha(through_, briefly) ? Mean::of_colours : Mean::of_values;
  }
  // For opaque fragments, RayCasterStage checks which face's fragment remains.
  if (!march_.background && !only_nearest_shows(measured_, probe_, {middle[0], middle[1]}, values_, through_))
    return back_faces_show;
  if (march_.background) {
    through_ = probe_.at(middle[0], middle[1], values_);
  } else if (!march_.shows_one_colour()) {
    march_.sum = plain_sum(through_, briefly);
  }
  march_.alpha_twice = !march_.shows_one_colour() && !march_.sum && !march_.background &&
                       multiplies_by_alpha(measured_.run.pipeline()) && grow_with_alpha(through_, briefly);
  const auto way = rays_.way(middle[0], middle[1]);
  if (march_.shows_one_colour() && (!way || steps_of_way(texels_, *way) < 2 * brief.length))
    return "rays of one length alone do not tell the step";
  return std::nullopt;
}

std::optional<Refusal> MarchMeasurement::find_translucent_value() {
  const auto middle = rays_.middle();
  TranslucentRay found{{middle[0], middle[1]}, values_[values_.size() / 2]};
  if (!march_.shows_one_colour()) {
    const auto translucent = translucent_ray(measured_, probe_, rays_, texels_, march_, values_);
    if (!translucent) return "no value is translucent on any ray: samples cannot be counted";
    found = *translucent;
  }
  if (measured_.neighbours || depends_on_gradient(measured_, probe_, found.ray, found.value)) {
    if (!measured_.neighbours || march_.shows_one_colour() || march_.sum || march_.alpha_twice ||
        march_.background)
      return "the colour depends on the gradient (lighting)";
    lit_ = true;
  }
  march_.translucent = found.value;
  return std::nullopt;
}

void MarchMeasurement::find_alpha_of_shortest_rays() {
  if (!march_.sum && march_.mean != Mean::of_colours) return;
  constexpr double none = 0.02;  // of a texel
  const auto dark = std::find_if(through_.begin(), through_.end(),
                                 [](const Rgba& ray) { return brightest_channel(ray) == 0; });
  if (dark == through_.end()) return;
  const float value = values_[std::size_t(dark - through_.begin())];
  if (shortest_seen(probe_, rays_, texels_, value, *dark) < none) march_.shortest_alpha = (*dark)[3];
}

double MarchMeasurement::shortest_with_sample() {
  const auto brightest = std::max_element(through_.begin(), through_.end(),
                                          [](const Rgba& a, const Rgba& b) { return a[3] < b[3]; });
  if (!((*brightest)[3] > 0)) return 0;
  return shortest_seen(probe_, rays_, texels_, values_[std::size_t(brightest - through_.begin())], *brightest);
}

std::optional<Refusal> MarchMeasurement::find_steps() {
  const auto& size = measured_.texture.size;
  if (march_.mean) return find_steps_of_mean();
  if (march_.extreme) {
    rules_ = rules_for_extremes(size, shortest_with_sample());
    return std::nullopt;
  }
  const auto count = [&] { return counted_rays(measured_, probe_, rays_, march_); };
  const auto counted = count();
  if (const auto* reason = std::get_if<std::string>(&counted)) return Refusal{*reason};
  const auto& all = std::get<std::vector<CountedRay>>(counted);
  const auto spaces = step_spaces(size, box_.camera.texture_to_clip, probe_);
  auto fits = that_count_as_measured(fit_steps(all, spaces), measured_.ways);
  if (fits.empty()) return "too few rays of several samples are in view to tell the step";
  if (fits.front().unexplained > most_unexplained) {
    auto finding = find_jitter(measured_.context, measured_.run, probe_, count, all, spaces);
    if (!finding) return samples_lie_elsewhere;
    march_.jitter = finding->jitter;
    fits = std::move(finding->fits);
  }
  take_rules(fits);
  for (const StepFit& fit : fits) metrics_.push_back(fit.metric);
  return std::nullopt;
}

std::optional<Refusal> MarchMeasurement::find_steps_of_mean() {
  for (const Mean mean : {Mean::of_colours, Mean::of_values}) {
    if (mean == Mean::of_colours && march_.mean != mean) continue;
    const auto counted = counted_by_means(probe_, box_, mean, values_, through_);
    const auto fits =
        fit_steps(counted, step_spaces(measured_.texture.size, box_.camera.texture_to_clip, probe_));
    if (fits.empty() || fits.front().unexplained > most_unexplained) continue;
    march_.mean = mean;
    take_rules(fits);
    return std::nullopt;
  }
  return "the samples that a mean is taken of cannot be counted";
}

void MarchMeasurement::take_rules(const std::vector<StepFit>& fits) {
  for (const StepFit& fit : fits) {
    std::vector<volume::RaySteps> of_fit = rules_of(fit);
    // A path divided into equal parts has as many samples wherever the first one begins: only constant steps
    // remain.
    if (march_.jitter || measured_.clipped || !box_.cuts.empty()) of_fit.resize(1);
    rules_.insert(rules_.end(), of_fit.begin(), of_fit.end());
  }
  // Planes, geometry and noise end rays elsewhere.
  if (march_.jitter || march_.mean || measured_.clipped || measured_.ends_at_geometry || !box_.cuts.empty())
    return;
  for (const StepFit& fit : fits) {
    const std::vector<volume::RaySteps> of_fit = rules_counting_ahead(fit);
    rules_.insert(rules_.end(), of_fit.begin(), of_fit.end());
  }
}

std::optional<Refusal> MarchMeasurement::take_offsets() {
  if (!march_.jitter) return std::nullopt;
  const auto offsets = ray_offsets(measured_.context, measured_.run, *march_.jitter);
  if (!offsets) return "the texture of noise at the rays' beginnings cannot be read back";
  for (volume::RaySteps& rule : rules_) {
    rule.offsets = offsets;
    if (march_.jitter->moves_only && !rule.counted_from) rule.counted_from = rule.first;
  }
  return std::nullopt;
}

std::optional<Refusal> MarchMeasurement::measure_samples() {
  if (!probe_.complete()) return "the driver offers no float framebuffer to probe with";
  if (auto refusal = find_composition()) return refusal;
  if (auto refusal = find_translucent_value()) return refusal;
  find_alpha_of_shortest_rays();
  if (auto refusal = find_steps()) return refusal;
  march_.table.low = measured_.range[0];
  march_.table.high = measured_.range[1];
  if (auto refusal = measure_table(measured_, probe_, rays_, rules_.front(), march_)) return refusal;
  take_opacity_limit(measured_, rules_.front(), probe_, rays_, march_);
  if (!fill_unseen(probe_, box_, rules_.front(), march_))
    return "a value that may hide what lies behind it has the colour of the shader's background";
  if (auto refusal = take_offsets()) return refusal;
  if (auto refusal = find_places()) return refusal;
  find_first_samples();
  return std::nullopt;
}

void MarchMeasurement::find_first_samples() {
  // If planes cut the box, or the eye is inside, samples must not lie beyond the end of their ray.
  if (march_.from_exit || measured_.clipped || !box_.cuts.empty()) return;
  for (volume::RaySteps& rule : rules_) {
    if (misplaced(rule, false).value_or(0) > most_misplaced) continue;
    rule.at_least_one = takes_first_sample_anyway(measured_, probe_, rays_, march_, rule, values_);
  }
}

std::optional<Refusal> MarchMeasurement::measure_light() {
  if (!lit_) return std::nullopt;
  if (!held_still(measured_, probe_, march_)) return "the noise at the rays' beginnings cannot be taken away";
  march_.steps = likeliest_rule();
  auto lights = measure_headlight(measured_, probe_, box_, march_);
  const bool fades = !measured_.tables_of_gradients.empty();
  auto* const refusal = std::get_if<Refusal>(&lights);
  if (refusal != nullptr && !(fades && refusal->reason == gradients_change_no_colour))
    return std::move(*refusal);
  if (refusal == nullptr) lights_ = std::get<std::vector<volume::Light>>(std::move(lights));
  if (!fades) return std::nullopt;
  return measure_gradient_opacity(measured_, probe_, box_, refusal == nullptr, march_, lights_);
}

std::optional<double> MarchMeasurement::misplaced(const volume::RaySteps& rule, bool from_exit) const {
  if (from_exit && !may_be_counted_from_exit(rule)) return std::nullopt;
  return misplaced_part(split_, rays_, from_exit ? counted_from_exit(rule, rays_, probe_) : rule).value_or(0);
}

double MarchMeasurement::least_misplaced(bool from_exit) const {
  double least = 1;
  for (const volume::RaySteps& rule : rules_) least = std::min(least, misplaced(rule, from_exit).value_or(1));
  return least;
}

const volume::RaySteps& MarchMeasurement::likeliest_rule() const {
  return *std::ranges::min_element(
      rules_, {}, [&](const volume::RaySteps& rule) { return misplaced(rule, march_.from_exit).value_or(1); });
}

std::optional<Refusal> MarchMeasurement::find_places_of_extremes() {
  auto steps = steps_of(ends_of_rays(measured_, probe_, march_.table, box_), measured_, probe_, box_);
  if (steps.empty()) {
    if (auto found = find_extreme_jitter(measured_, probe_, march_.table, box_)) {
      march_.jitter = found->jitter;
      steps = std::move(found->steps);
      rules_.clear();
    }
  }
  extremes_seen_ = steps.size();
  rules_.insert(rules_.begin(), steps.begin(), steps.end());
  return take_offsets();
}

std::optional<Refusal> MarchMeasurement::find_places() {
  if (march_.extreme) return find_places_of_extremes();
  // With the eye inside, rays of all directions begin at one point.
  if (march_.mean || !box_.cuts.empty()) return std::nullopt;
  if (march_.jitter && !show_own_noise(measured_.run, probe_, *march_.jitter)) return std::nullopt;
  const std::vector<SeenValue> seen = seen_values(values_, through_);
  const auto split = [&] { return split_rays(measured_, probe_, march_, box_, seen); };
  split_ = split();
  if (march_.jitter || least_misplaced(false) <= misplaced_by_rounding) return std::nullopt;
  std::erase_if(rules_, [](const volume::RaySteps& rule) { return rule.counted_from.has_value(); });
  const double misplaced = least_misplaced(false);
  // The samples of an evenly divided path come close to steps from its end. In views in which both ends of rays
  // are alike, neither explains much more than the other.
  march_.from_exit = least_misplaced(true) <= std::min(misplaced / 3, most_misplaced);
  if (march_.from_exit || misplaced <= most_misplaced) return std::nullopt;
  march_.jitter = find_moving_jitter(measured_.context, measured_.run, probe_, split, rays_, rules_);
  return take_offsets();
}

void MarchMeasurement::add_lit_marches(March march, std::vector<March>& marches) const {
  for (const volume::Light& light : lights_) {
    march.light = light;
    for (const bool rounds : {false, true}) {
      if (rounds && !may_be_rounded(measured_.texture)) continue;
      march.rounds_samples = rounds;
      marches.push_back(march);
    }
  }
}

void MarchMeasurement::add_marches(const CoordinateSpace& space, const volume::Box& region,
                                   const volume::RaySteps& rule, bool seen, std::vector<March>& marches) const {
  March march = march_;
  march.space = space;
  march.steps = rule;
  march.alike_metrics = {rule.metric};
  for (const auto& metric : metrics_) {
    if (!of_one_shape(metric, rule.metric)) march.alike_metrics.push_back(metric);
  }
  march.steps.at_least_one = rule.at_least_one && may_count_ahead(rule, region);
  march.steps_seen = seen;
  // Programs usually take the step that reaches the opaque geometry before they detect it.
  march.steps.past_depth = measured_.ends_at_geometry ? 1 : 0;
  // Planes may end rays as opaque geometry does, or not; both images are alike if no ray leaves by a plane.
  for (const double past_planes : {march.steps.past_depth, 1 - march.steps.past_depth}) {
    if (!measured_.clipped && past_planes != march.steps.past_depth) continue;
    march.past_planes = past_planes;
    if (!lights_.empty()) {
      add_lit_marches(march, marches);
      continue;
    }
    marches.push_back(march);
    // Constant fields do not show which extreme it is.
    if (!march.extreme) continue;
    marches.push_back(march);
    marches.back().extreme = volume::Operator::min;
  }
}

bool MarchMeasurement::may_count_ahead(const volume::RaySteps& rule, const volume::Box& region) const {
  if (!volume::is_all_of_texture(region, measured_.texture.size)) return false;
  // validate() refuses samples beyond such textures.
  const auto ends = [&](volume::Wrap wrap) {
    return wrap == volume::Wrap::repeat ||
           (wrap == volume::Wrap::border && measured_.texture.filter == volume::Filter::nearest);
  };
  return !rule.any_beyond_end() || std::ranges::none_of(measured_.texture.wrap, ends);
}

MarchFinding MarchMeasurement::marches(const std::vector<CoordinateSpace>& spaces,
                                       const std::vector<std::optional<ProxyBox>>& boxes) const {
  std::vector<March> marches;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (!boxes[i]) continue;
    const RaysThroughBox rays(boxes[i]->camera.texture_to_clip, boxes[i]->region, boxes[i]->cuts);
    for (std::size_t r = 0; r < rules_.size(); ++r) {
      const bool seen = !march_.extreme || (i == 0 && r < extremes_seen_);
      if (march_.from_exit && !may_be_counted_from_exit(rules_[r])) continue;
      if (rules_[r].counted_from && !may_count_ahead(rules_[r], boxes[i]->region)) continue;
      const volume::RaySteps placed = march_.from_exit ? counted_from_exit(rules_[r], rays, probe_) : rules_[r];
      const auto misplaced = misplaced_part(split_, rays, placed);
      // Fields must have confirmed that the box is the whole texture, and where samples lie that are counted
      // ahead.
      if (!misplaced && spaces[i].of_whole_box) continue;
      if (rules_[r].counted_from && !march_.jitter && !(misplaced && *misplaced <= misplaced_by_rounding))
        continue;
      if (misplaced.value_or(0) <= most_misplaced)
        add_marches(spaces[i], boxes[i]->region, rules_[r], seen, marches);
    }
  }
  if (marches.empty()) return samples_lie_elsewhere;
  return marches;
}

/// Measures in spaces that differ by an offset alone: steps have one length in all of them.
MarchFinding measure_in(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces) {
  std::vector<std::optional<ProxyBox>> boxes;
  boxes.reserve(spaces.size());
  for (const CoordinateSpace& space : spaces) boxes.push_back(proxy_box(measured, space));
  if (!boxes.front()) return samples_lie_elsewhere;
  MarchMeasurement measurement(measured, *boxes.front());
  if (auto refusal = measurement.measure_samples()) return *std::move(refusal);
  MarchFinding finding = measurement.marches(spaces, boxes);
  if (std::holds_alternative<Refusal>(finding)) return finding;
  if (auto refusal = measurement.measure_light()) return *std::move(refusal);
  return measurement.marches(spaces, boxes);
}

}  // namespace

MarchFinding measure_march(const MarchContext& measured, const std::vector<CoordinateSpace>& spaces) {
  if (measured.texture.base == BaseFormat::rgba) return "a ray caster over a texture of colours";
  MarchFinding finding = samples_lie_elsewhere;
  for (auto first = spaces.begin(); first != spaces.end();) {
    const auto last = std::find_if(first, spaces.end(), [&](const CoordinateSpace& space) {
      return space.scale != first->scale || space.input != first->input || space.origin != first->origin;
    });
    finding = measure_in(measured, {first, last});
    const auto* const refusal = std::get_if<Refusal>(&finding);
    if (refusal == nullptr || refusal->reason != samples_lie_elsewhere.reason) return finding;
    first = last;
  }
  return finding;
}

}  // namespace understudy::spu
