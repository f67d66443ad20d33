// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/shader_background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/sample_places.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;
using volume::Vec3;

namespace {

constexpr double float_rounding = 2e-7;  ///< of a colour up to 1

double distance(const Vec3& a, const Vec3& b) {
  return volume::length(volume::subtract(a, b));
}

/// Rays that have the same number of samples, recognised by their colour.
struct ColourLevel {
  Ray ray;
  Vec3 colour;
  double along = 0;  ///< distance from the colour of the shortest ray, towards that of the longest
};

class BackgroundSearch {
 public:
  BackgroundSearch(FieldProbe& probe, const RaysThroughBox& rays, const volume::RaySteps& texels,
                   const std::vector<float>& values)
      : probe_(probe), rays_(rays), texels_(texels), values_(values) {}

  std::optional<FoundBackground> found();

 private:
  /// Returns the colours of all values on a ray; null if a fragment is missing or has another alpha.
  std::optional<std::vector<Vec3>> colours_on(const Ray& ray);
  std::vector<std::size_t> clearest_values();
  std::vector<ColourLevel> levels_of(float value);
  bool take_levels(const std::vector<ColourLevel>& levels);
  bool take_background();
  void add_longer_rays();
  /// Returns how many samples a longer ray has, by the value that shows it best; null if none does.
  std::optional<double> samples_on(const std::vector<Vec3>& colours) const;
  BackgroundContrast contrast(std::size_t value) const;

  FieldProbe& probe_;
  const RaysThroughBox& rays_;
  const volume::RaySteps& texels_;
  const std::vector<float>& values_;
  std::optional<float> alpha_;
  std::vector<Vec3> longest_;  ///< colours of all values on the longest ray
  std::optional<Ray> empty_;   ///< a ray without samples
  std::vector<Ray> places_;
  std::vector<double> samples_;             ///< of each place, in ascending order
  std::vector<std::vector<Vec3>> colours_;  ///< by place and value
  ShaderBackground background_;
};

std::optional<std::vector<Vec3>> BackgroundSearch::colours_on(const Ray& ray) {
  constexpr float same_alpha = 1e-6F;
  const std::vector<Rgba> fragments = probe_.at(ray.x, ray.y, values_);
  if (!finite(fragments)) return std::nullopt;
  std::vector<Vec3> colours;
  colours.reserve(fragments.size());
  for (const Rgba& fragment : fragments) {
    if (!alpha_) alpha_ = fragment[3];
    if (!(*alpha_ > 0) || std::abs(fragment[3] - *alpha_) > same_alpha) return std::nullopt;
    colours.push_back(colour_of(fragment));
  }
  return colours;
}

/// Returns three values whose colours keep growing on short rays: the clearest, and two that are less clear.
std::vector<std::size_t> BackgroundSearch::clearest_values() {
  const auto shorter = colours_on(ray_of_length(rays_, texels_, 1.5));
  const auto longer = colours_on(ray_of_length(rays_, texels_, 12));
  if (!shorter || !longer) return {};
  std::vector<std::size_t> order(values_.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return distance((*longer)[a], (*shorter)[a]) > distance((*longer)[b], (*shorter)[b]);
  });
  return {order[0], order[order.size() / 16], order[order.size() / 4]};
}

std::vector<ColourLevel> BackgroundSearch::levels_of(float value) {
  constexpr double shortest = 0.03;  // in texels
  constexpr int lengths = 75;        // up to 35 texels
  constexpr double growth = 1.1;
  const std::array one{value};
  std::vector<ColourLevel> seen;
  double length = shortest;
  for (int i = 0; i < lengths; ++i, length *= growth) {
    const Ray ray = ray_of_length(rays_, texels_, length);
    const Rgba fragment = probe_.at(ray.x, ray.y, one).front();
    if (reached(fragment)) seen.push_back({ray, colour_of(fragment)});
  }
  if (seen.empty()) return {};
  const Vec3 base = seen.front().colour;
  const Vec3 all = volume::subtract(seen.back().colour, base);
  const double reach = volume::length(all);
  if (reach < 1e-3) return {};
  for (ColourLevel& level : seen) level.along = volume::dot(volume::subtract(level.colour, base), all) / reach;
  std::ranges::stable_sort(seen, {}, &ColourLevel::along);
  const double apart = std::max(10 * float_rounding, 1e-3 * reach);
  std::vector<ColourLevel> levels;
  for (const ColourLevel& level : seen) {
    if (levels.empty() || level.along - levels.back().along > apart) levels.push_back(level);
  }
  return levels;
}

/// Takes three steps between four levels, if each is shorter by the same factor. (Those of a sum have one
/// length.)
bool BackgroundSearch::take_levels(const std::vector<ColourLevel>& levels) {
  if (levels.size() < 4) return false;
  std::array<double, 3> steps{};
  for (std::size_t i = 0; i < 3; ++i) steps[i] = levels[i + 1].along - levels[i].along;
  const double rounding = 4 * float_rounding / steps[2];
  const double transparency = steps[1] / steps[0];
  if (std::abs(steps[2] / steps[1] - transparency) > 2e-3 + rounding) return false;
  if (!(transparency < 1 - 1e-4 - rounding)) return false;
  places_.clear();
  samples_.clear();
  colours_.clear();
  for (std::size_t i = 0; i < 4; ++i) {
    auto colours = colours_on(levels[i].ray);
    if (!colours) return false;
    places_.push_back(levels[i].ray);
    samples_.push_back(double(i + 1));
    colours_.push_back(std::move(*colours));
  }
  // If all values look alike, this ray has no sample yet.
  const bool begins_empty = std::ranges::all_of(colours_.front(), [&](const Vec3& colour) {
    return distance(colour, colours_.front().front()) <= 10 * float_rounding;
  });
  if (begins_empty) {
    empty_ = places_.front();
    background_.colour = colours_.front().front();
    places_.erase(places_.begin());
    colours_.erase(colours_.begin());
    samples_.pop_back();
  }
  return true;
}

/// Finds the background: it lies one step before the colour of one sample, whatever the value.
bool BackgroundSearch::take_background() {
  constexpr double clear = 0.01;
  constexpr double same = 5e-3;
  std::vector<Vec3> backgrounds;
  double clearest = 0;
  Vec3 best{};
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const Vec3 first = volume::subtract(colours_[1][i], colours_[0][i]);
    const Vec3 second = volume::subtract(colours_[2][i], colours_[1][i]);
    const double square = volume::dot(first, first);
    const double transparency = square > 0 ? volume::dot(second, first) / square : 0;
    if (square < clear * clear || transparency < 0.1 || transparency > 1) continue;
    backgrounds.push_back(volume::subtract(colours_[0][i], volume::scale(first, 1 / transparency)));
    if (square * transparency <= clearest) continue;
    clearest = square * transparency;
    best = backgrounds.back();
  }
  if (empty_) best = background_.colour;
  if (backgrounds.empty() && !empty_) return false;
  // If the first ray had more than one sample, every value would give another background.
  const auto others =
      std::ranges::count_if(backgrounds, [&](const Vec3& one) { return distance(one, best) > same; });
  if (others > std::ptrdiff_t(backgrounds.size() / 10)) return false;
  background_.colour = best;
  if (empty_) return true;
  // An invisible value gives the background exactly.
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (distance(longest_[i], best) > same || distance(longest_[i], colours_[0][i]) > 10 * float_rounding)
      continue;
    background_.colour = longest_[i];
    break;
  }
  return true;
}

BackgroundContrast BackgroundSearch::contrast(std::size_t value) const {
  std::vector<Vec3> differences;
  differences.reserve(colours_.size());
  for (const std::vector<Vec3>& colours : colours_)
    differences.push_back(volume::subtract(colours[value], background_.colour));
  return contrast_of(samples_, differences);
}

std::optional<double> BackgroundSearch::samples_on(const std::vector<Vec3>& colours) const {
  constexpr double least = 0.05;
  constexpr double most = 0.9;
  constexpr double whole = 0.15;
  std::optional<double> samples;
  double nearest = 1;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const BackgroundContrast known = contrast(i);
    const double opacity = opacity_of(known, volume::subtract(colours[i], background_.colour));
    if (opacity < least || opacity > most || known.alpha >= 1) continue;
    // One sample must exceed rounding, as the count is based on it.
    if (known.alpha * volume::length(known.full) < 1e-3 || std::abs(opacity - 0.5) >= nearest) continue;
    const double count = std::log1p(-opacity) / std::log1p(-known.alpha);
    if (std::abs(count - std::round(count)) > whole) continue;
    nearest = std::abs(opacity - 0.5);
    samples = std::round(count);
  }
  return samples;
}

void BackgroundSearch::add_longer_rays() {
  for (const double length : {6.0, 12.0, 24.0, 48.0, 96.0}) {
    const Ray ray = ray_of_length(rays_, texels_, length);
    auto colours = colours_on(ray);
    if (!colours) continue;
    const auto samples = samples_on(*colours);
    if (!samples || *samples <= samples_.back()) continue;
    places_.push_back(ray);
    samples_.push_back(*samples);
    colours_.push_back(std::move(*colours));
  }
}

std::optional<FoundBackground> BackgroundSearch::found() {
  const auto middle = rays_.middle();
  auto longest = colours_on({middle[0], middle[1]});
  if (!longest) return std::nullopt;
  longest_ = std::move(*longest);
  for (const std::size_t value : clearest_values()) {
    empty_.reset();
    if (!take_levels(levels_of(values_[value])) || !take_background()) continue;
    background_.alpha = *alpha_;
    add_longer_rays();
    FoundBackground found{background_, {}};
    for (std::size_t i = 0; i < places_.size(); ++i)
      found.rays.push_back({places_[i].x, places_[i].y, samples_[i]});
    return found;
  }
  return std::nullopt;
}

/// A ray through the middle of the box whose far part is opaque: values in front of it may hide it.
class HiddenBehind {
 public:
  /// Null if the eye is inside the box, its middle is out of view, or no plane of a field lies in it.
  static std::optional<HiddenBehind> in_middle_of(FieldProbe& probe, const ProxyBox& box,
                                                  const volume::RaySteps& steps, const March& march);

  bool hides(FieldProbe& probe, float value) const {
    const Rgba ray = seen(probe, value);
    return reached(ray) && ray[3] < least_;
  }
  /// Returns the opacity of one sample, by how much of what lies behind is visible; null if that is too little
  /// to measure.
  std::optional<float> opacity_of_sample(FieldProbe& probe, float value) const;

 private:
  Rgba seen(FieldProbe& probe, float value) const {
    FieldProbe::SplitField field = opaque_;
    (forwards_ ? field.before : field.behind) = value;
    return probe.pixel(column_, row_, field);
  }

  int column_ = 0;
  int row_ = 0;
  FieldProbe::SplitField opaque_;
  bool forwards_ = true;  ///< the ray goes along the axis of the field
  float least_ = 0;       ///< the far part is hidden if the ray's opacity is less
  double in_front_ = 0;   ///< samples in front of the plane
  float behind_ = 0;      ///< opacity of those behind it
};

std::optional<float> HiddenBehind::opacity_of_sample(FieldProbe& probe, float value) const {
  constexpr double fewest = 2;
  constexpr float least_behind = 0.5F;
  constexpr double least_told = 0.02;
  const Rgba ray = seen(probe, value);
  if (!reached(ray) || in_front_ < fewest || behind_ < least_behind) return std::nullopt;
  const double through = std::min(1.0, double(ray[3]) / double(behind_));
  if (through < least_told) return std::nullopt;
  return float(1 - std::pow(through, 1 / in_front_));
}

std::optional<HiddenBehind> HiddenBehind::in_middle_of(FieldProbe& probe, const ProxyBox& box,
                                                       const volume::RaySteps& steps, const March& march) {
  constexpr float visible = 0.02F;
  constexpr double part_behind = 0.3;  // of the samples, at least: the plane lies at 0.37 of the box
  if (!box.cuts.empty()) return std::nullopt;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region);
  const auto middle = rays.middle();
  HiddenBehind ray;
  ray.column_ = probe.column_at(middle[0]);
  ray.row_ = probe.row_at(middle[1]);
  const auto way = rays.way(probe.x_of(ray.column_), probe.y_of(ray.row_));
  if (!way) return std::nullopt;
  const double samples = part_behind * samples_of_length(steps, steps_of_way(steps, *way));
  const std::vector<Rgba>& entries = march.table.entries;
  const auto most = std::ranges::max_element(entries, {}, [](const Rgba& entry) { return entry[3]; });
  const float opaque = value_at({march.table.low, march.table.high},
                                double(most - entries.begin()) / double(entries.size() - 1));
  const auto fields = split_fields(box.region, *way, opaque, opaque);
  if (fields.empty()) return std::nullopt;
  ray.opaque_ = fields.front();
  ray.forwards_ = (*way)[ray.opaque_.axis] > 0;
  // A ray that the program terminates early is no more opaque than its limit.
  ray.least_ = std::min(ray_of(march, *most, samples)[3], march.opacity_limit) - visible;
  const double length = steps_of_way(steps, *way);
  const double all = samples_of_length(steps, length);
  const auto through = rays.through(probe.x_of(ray.column_), probe.y_of(ray.row_));
  if (!through) return std::nullopt;
  const double part = (ray.opaque_.plane - through->entry[ray.opaque_.axis]) / through->way[ray.opaque_.axis];
  ray.in_front_ = std::clamp(std::floor(part * (steps.divided ? all : length) - steps.first) + 1, 0.0, all);
  ray.behind_ = ray_of(march, *most, all - ray.in_front_)[3];
  return ray;
}

/// Fills entries from `first` up to `end` linearly between their neighbours.
void fill_between(std::vector<Rgba>& entries, std::size_t first, std::size_t end) {
  const Rgba low = entries[first - 1];
  const Rgba high = entries[end];
  for (std::size_t i = first; i < end; ++i) {
    const float part = float(i - first + 1) / float(end - first + 1);
    for (std::size_t c = 0; c < 4; ++c) entries[i][c] = low[c] + part * (high[c] - low[c]);
  }
}

}  // namespace

std::optional<FoundBackground> find_background(FieldProbe& probe, const RaysThroughBox& rays,
                                               const volume::RaySteps& texels,
                                               const std::vector<float>& values) {
  return BackgroundSearch(probe, rays, texels, values).found();
}

bool hides_what_was_there(const Pipeline& pipeline, float alpha) {
  constexpr float opaque = 1 - 1e-6F;
  const Blending& blending = pipeline.blending;
  if (blending.replaces) return true;
  return alpha >= opaque && alpha <= 1 && blending.op == volume::Operator::over &&
         blending.front_to_back == FrontToBack::no &&
         (blending.alpha.untouched ? pipeline.target.alpha_bits == 0
                                   : blending.alpha.op == volume::Operator::over);
}

std::optional<ShaderBackground> remove_background(const MarchContext& measured, FieldProbe& probe,
                                                  const RaysThroughBox& rays) {
  volume::RaySteps texels;
  for (std::size_t k = 0; k < 3; ++k) texels.metric[4 * k] = measured.texture.size[k];
  auto found = find_background(probe, rays, texels, values_over(measured.range));
  if (!found || !hides_what_was_there(measured.run.pipeline(), found->background.alpha)) return std::nullopt;
  probe.remove(found->background, std::move(found->rays));
  return found->background;
}

bool remove_known_background(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                             const March& march) {
  constexpr double same = 1e-3;
  if (!march.background) return true;
  const auto found = remove_background(measured, probe, rays);
  return found && distance(found->colour, march.background->colour) < same;
}

namespace {

/// Gives entries that look like the program's background their opacity; false if it cannot be measured.
bool measure_unseen(const HiddenBehind& hidden_behind, FieldProbe& probe, std::size_t first, std::size_t end,
                    March& march) {
  constexpr std::size_t most_measured = 128;  // each takes a draw
  if (end - first > most_measured) return false;
  // With early ray termination, how much is visible depends on what lies in front.
  if (march.opacity_limit < 1) return false;
  std::vector<Rgba>& entries = march.table.entries;
  for (std::size_t entry = first; entry < end; ++entry) {
    const float value =
        value_at({march.table.low, march.table.high}, double(entry) / double(entries.size() - 1));
    if (!hidden_behind.hides(probe, value)) continue;
    const auto opacity = hidden_behind.opacity_of_sample(probe, value);
    if (!opacity) return false;
    for (std::size_t c = 0; c < 3; ++c) entries[entry][c] = *opacity * float(march.background->colour[c]);
    entries[entry][3] = *opacity;
  }
  return true;
}

}  // namespace

bool fill_unseen(FieldProbe& probe, const ProxyBox& box, const volume::RaySteps& steps, March& march) {
  constexpr std::size_t longest_filled = 4;  // an 8-bit value spans as many entries
  constexpr std::size_t tested_apart = longest_filled;
  if (!march.background) return true;
  const auto hidden_behind = HiddenBehind::in_middle_of(probe, box, steps, march);
  if (!hidden_behind) return false;
  std::vector<Rgba>& entries = march.table.entries;
  const std::array range{march.table.low, march.table.high};
  const auto hides = [&](std::size_t entry) {
    return hidden_behind->hides(probe, value_at(range, double(entry) / double(entries.size() - 1)));
  };
  for (std::size_t first = 0; first < entries.size(); ++first) {
    if (entries[first][3] > 0) continue;
    std::size_t end = first;
    while (end < entries.size() && !(entries[end][3] > 0)) ++end;
    const std::size_t count = end - first;
    const bool between = first > 0 && end < entries.size();
    if (between && count <= longest_filled) {
      if (hides(first + count / 2)) fill_between(entries, first, end);
    } else {
      bool hidden = false;
      for (std::size_t entry = first; entry < end; entry += tested_apart) hidden |= hides(entry);
      if (hidden && !measure_unseen(*hidden_behind, probe, first, end, march)) return false;
    }
    first = end;
  }
  return true;
}

}  // namespace understudy::spu
