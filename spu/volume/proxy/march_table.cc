// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <variant>
#include <vector>

#include "spu/volume/proxy/background_removal.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/step_fit.h"
#include "spu/volume/texture/value_range.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// A ray more opaque than this says little about one sample.
constexpr float opaque = 0.6F;

const Refusal no_short_ray{"no short ray is in view: the opacity of one sample cannot be told"};

/// The colours of one ray over constant fields of all values of the table.
struct RayOfTable {
  double samples = 0;
  std::vector<Rgba> colours;  ///< premultiplied

  bool shows_anything() const {
    return std::ranges::any_of(colours, [](const Rgba& colour) {
      return std::ranges::any_of(colour, [](float component) { return component > 0; });
    });
  }
};

/// Probes rays for the table of one march.
class TableRays {
 public:
  TableRays(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
            const volume::RaySteps& rule, const March& march)
      : probe_(probe),
        rays_(rays),
        rule_(rule),
        march_(march),
        premultiplied_(premultiplied_already(measured, march)) {
    values_.reserve(probed_entries_of_rays);
    for (int i = 0; i < probed_entries_of_rays; ++i)
      values_.push_back(value_at(measured.range, double(i) / (probed_entries_of_rays - 1)));
  }

  /// Returns the ray in view whose number of samples comes closest; `within` a step, where in the step it ends.
  std::variant<RayOfTable, Refusal> of_samples(double samples, double within = 0.5) {
    const double wanted = samples - 1 + within + (rule_.divided ? 0.5 : rule_.first);
    // An extreme is the same on every ray that has a sample; a short ray may have none, as the step is unknown.
    const auto middle = rays_.middle();
    const Ray ray = march_.shows_one_colour() ? Ray{middle[0], middle[1]} : ray_of_length(rays_, rule_, wanted);
    RayOfTable seen{march_.shows_one_colour() ? 1 : samples_of_length(rule_, ray.length), {}};
    if (seen.samples < 1) return no_short_ray;
    const auto fragments = probe_.at(ray.x, ray.y, values_);
    if (!finite(fragments)) return Refusal{"the fragment stage gives colours that are not finite"};
    if (march_.shows_one_colour() && !std::ranges::all_of(fragments, reached)) return no_short_ray;
    for (const Rgba& fragment : fragments) seen.colours.push_back(premultiplied(fragment, premultiplied_));
    return seen;
  }

  /// Returns the ray through the middle of the view, over fields that show something only in a layer, which
  /// holds about `samples` of its samples: with the eye inside, all rays are long. Null if no value is
  /// invisible, or if samples are not composed by over one by one.
  std::optional<RayOfTable> of_layer(int samples);

 private:
  /// Returns a value that is invisible on the ray through the middle; null if there is none.
  std::optional<float> clear_value();

  FieldProbe& probe_;
  const RaysThroughBox& rays_;
  const volume::RaySteps& rule_;
  const March& march_;
  bool premultiplied_;
  std::vector<float> values_;
  bool looked_for_clear_ = false;
  std::optional<float> clear_;
};

std::optional<float> TableRays::clear_value() {
  if (looked_for_clear_) return clear_;
  looked_for_clear_ = true;
  const auto middle = rays_.middle();
  const auto fragments = probe_.at(middle[0], middle[1], values_);
  for (std::size_t i = 0; i < fragments.size() && !clear_; ++i) {
    if (std::ranges::all_of(fragments[i], [](float component) { return component == 0; })) clear_ = values_[i];
  }
  return clear_;
}

std::optional<RayOfTable> TableRays::of_layer(int samples) {
  constexpr double fewest_texels = 3;  // per sample
  constexpr double whole = 0.1;        // how far a count may be from a whole number
  if (march_.shows_one_colour() || march_.sum || march_.background || march_.alpha_twice) return std::nullopt;
  const auto middle = rays_.middle();
  const auto ray = rays_.through(middle[0], middle[1]);
  const auto clear = ray ? clear_value() : std::nullopt;
  if (!clear) return std::nullopt;
  const std::vector<double> places = places_on_way(rule_, ray->way);
  const std::size_t first = places.size() / 2;
  const std::size_t end = first + std::size_t(samples);
  if (first == 0 || end >= places.size()) return std::nullopt;
  FieldProbe::Layer layer{0, 0, 1, *clear};
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (std::abs(ray->way[axis]) > std::abs(ray->way[layer.axis])) layer.axis = axis;
  }
  const auto between = [&](std::size_t sample) {
    return ray->entry[layer.axis] + ray->way[layer.axis] * (places[sample - 1] + places[sample]) / 2;
  };
  std::tie(layer.low, layer.high) = std::minmax({between(first), between(end)});
  if (!(layer.low > 0 && layer.high < 1) ||
      (layer.high - layer.low) * probe_.finest_texels() < fewest_texels * samples)
    return std::nullopt;
  // The layer may hold one sample more or less, because where samples lie within a step is not known yet. The
  // opacities of a translucent value on the whole ray and in the layer give the number.
  const std::array translucent{march_.translucent};
  const auto seen_of = [&](const std::vector<Rgba>& fragments) {
    return reached(fragments.front()) ? std::log1p(-double(premultiplied(fragments.front(), premultiplied_)[3]))
                                      : 0;
  };
  const double all = seen_of(probe_.at(middle[0], middle[1], translucent));
  const double in_layer = seen_of(probe_.at_layer(middle[0], middle[1], layer, translucent));
  const double count = in_layer / all * double(places.size());
  if (!(count > 1 - whole) || std::abs(count - std::round(count)) > whole) return std::nullopt;
  RayOfTable seen{std::round(count), {}};
  const auto fragments = probe_.at_layer(middle[0], middle[1], layer, values_);
  if (!finite(fragments)) return std::nullopt;
  for (const Rgba& fragment : fragments) seen.colours.push_back(premultiplied(fragment, premultiplied_));
  return seen;
}

/// Returns how many samples the longer ray has, given what the shorter one shows of each. At the silhouette of
/// the box, where rays are short, their length changes by a sample within a small part of a pixel, and counts
/// of samples by the geometry are off by one. Null if the rays agree for no number.
std::optional<double> samples_by(const March& march, const RayOfTable& shorter, const RayOfTable& longer) {
  constexpr int most_off = 2;
  constexpr double tolerance = 0.004;
  constexpr float tells = 0.01F;
  std::optional<double> best;
  double least = tolerance;
  for (int off = -most_off; off <= most_off; ++off) {
    const double samples = longer.samples + off;
    double difference = 0;
    std::size_t told = 0;
    for (std::size_t i = 0; i < shorter.colours.size() && samples >= 1; ++i) {
      const float seen = amount(march, shorter.colours[i]);
      const float through_longer = amount(march, longer.colours[i]);
      // An opacity that does not grow with the path is a floor set by the program, and says nothing about
      // samples.
      if (through_longer < tells || through_longer > opaque || through_longer < 1.2F * seen) continue;
      const Rgba one = sample_of(march, shorter.colours[i], shorter.samples);
      difference += std::abs(amount(march, ray_of(march, one, samples)) - through_longer);
      ++told;
    }
    if (told == 0) return longer.samples;
    if (difference / double(told) >= least) continue;
    least = difference / double(told);
    best = samples;
  }
  return best;
}

/// Returns the shortest ray that shows anything and agrees with the `longer` ones, whose samples it counts
/// anew. At the box's silhouette, where rays are shortest, the one that was sought may just miss its pixel.
std::variant<RayOfTable, Refusal> shortest_ray(TableRays& table, const March& march,
                                               std::vector<RayOfTable>& longer) {
  struct Length {
    double samples;
    double within;
  };
  for (const Length length :
       {Length{1, 0.5}, Length{1, 0.35}, Length{1, 0.65}, Length{2, 0.5}, Length{3, 0.5}}) {
    auto seen = table.of_samples(length.samples, length.within);
    const auto* ray = std::get_if<RayOfTable>(&seen);
    if (ray == nullptr || march.shows_one_colour()) return seen;
    const bool nothing_to_see = std::ranges::none_of(longer, &RayOfTable::shows_anything) && !longer.empty();
    if (!ray->shows_anything() && !nothing_to_see) continue;
    std::vector<double> counts;
    for (const RayOfTable& other : longer) {
      if (const auto samples = samples_by(march, *ray, other)) counts.push_back(*samples);
    }
    if (counts.size() < longer.size()) continue;
    for (std::size_t i = 0; i < counts.size(); ++i) longer[i].samples = counts[i];
    return seen;
  }
  return no_short_ray;
}

/// Likewise, if the eye is inside and no ray in view is short.
std::variant<RayOfTable, Refusal> shortest_layer(TableRays& table, std::vector<RayOfTable>& longer) {
  auto shortest = table.of_layer(1);
  if (!shortest) return no_short_ray;
  longer.clear();
  if (auto layer = table.of_layer(8)) longer.push_back(*std::move(layer));
  return *std::move(shortest);
}

}  // namespace

std::optional<Refusal> measure_table(const MarchContext& measured, FieldProbe& probe,
                                     const RaysThroughBox& rays, const volume::RaySteps& rule, March& march) {
  constexpr float saturated = 0.97F;
  constexpr double most_samples_of_shortest = 8;
  TableRays table(measured, probe, rays, rule, march);
  std::vector<RayOfTable> longer;
  for (const double samples : {6.0, 40.0}) {
    if (march.shows_one_colour()) break;
    auto seen = table.of_samples(samples);
    auto* const ray = std::get_if<RayOfTable>(&seen);
    if (ray == nullptr) return std::get<Refusal>(seen);
    if (std::abs(ray->samples - samples) <= samples / 2) longer.push_back(std::move(*ray));
  }
  auto found = shortest_ray(table, march, longer);
  const auto* const in_view = std::get_if<RayOfTable>(&found);
  const bool short_enough = in_view != nullptr && in_view->samples <= most_samples_of_shortest;
  // A layer has gradients, by which light would change colours.
  if (!short_enough && !measured.neighbours) {
    auto layer = shortest_layer(table, longer);
    if (std::holds_alternative<RayOfTable>(layer)) found = std::move(layer);
  }
  if (const auto* refusal = std::get_if<Refusal>(&found)) return *refusal;
  const auto& shortest = std::get<RayOfTable>(found);
  auto& entries = march.table.entries;
  entries.clear();
  for (const Rgba& colour : shortest.colours) {
    // However much denser its samples were, a saturated ray of many would look alike.
    if (shortest.samples > most_samples_of_shortest && amount(march, colour) > saturated) return no_short_ray;
    entries.push_back(march.shows_one_colour() ? colour : sample_of(march, colour, shortest.samples));
  }
  for (const RayOfTable& ray : longer) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const float seen = amount(march, ray.colours[i]);
      if (seen >= opaque) continue;
      // An opacity that does not grow with the path is the program's floor.
      const bool grows = seen > amount(march, shortest.colours[i]) + 1e-5F;
      entries[i] =
          grows ? sample_of(march, ray.colours[i], ray.samples) : Rgba{0, 0, 0, march.sum ? 1.0F : 0.0F};
    }
  }
  return std::nullopt;
}

namespace {

/// Whether samples of this colour are invisible in front of the program's own background, however opaque they
/// are.
bool looks_like_background(const March& march, const Rgba& sample) {
  constexpr double unseen = 1e-3;  // of a sample's opacity
  if (!march.background) return false;
  const volume::Vec3 contrast =
      volume::subtract(colour_of(sample), volume::scale(march.background->colour, double(sample[3])));
  return volume::length(contrast) <= unseen * double(sample[3]);
}

}  // namespace

std::optional<float> half_seen_value(const March& march, const volume::Vec3& way) {
  float nearest = 0.48F;
  std::optional<float> value;
  const volume::TransferFunction& table = march.table;
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    if (looks_like_background(march, table.entries[i])) continue;
    const float seen = amount(march, ray_of(march, table.entries[i], steps_of_way(march.steps, way)));
    if (std::abs(seen - 0.5F) >= nearest) continue;
    nearest = std::abs(seen - 0.5F);
    value = value_at({table.low, table.high}, double(i) / double(table.entries.size() - 1));
  }
  return value;
}

}  // namespace understudy::spu
