// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/march_table.h"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Multiples of 1/255 fall on entries.
constexpr int table_entries = 4 * 255 + 1;
/// A ray that lets through less than this tells little of one sample.
constexpr float opaque = 0.6F;

const Refusal no_short_ray{"no short ray is in view: the opacity of one sample cannot be told"};

/// The colours of one ray over fields of all values of the table.
struct RayOfTable {
  double samples = 0;
  std::vector<Rgba> colours;  ///< premultiplied

  bool shows_anything() const {
    return std::ranges::any_of(colours, [](const Rgba& colour) {
      return std::ranges::any_of(colour, [](float component) { return component > 0; });
    });
  }
};

/// Looks at rays for the table of one march.
class TableRays {
 public:
  TableRays(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
            const volume::RaySteps& rule, const March& march)
      : probe_(probe),
        rays_(rays),
        rule_(rule),
        march_(march),
        premultiplied_(premultiplied_already(measured, march)) {
    values_.reserve(table_entries);
    for (int i = 0; i < table_entries; ++i)
      values_.push_back(value_at(measured.range, double(i) / (table_entries - 1)));
  }

  /// The ray in view whose number of samples comes closest; `within` a step, where in the step it ends.
  std::variant<RayOfTable, Refusal> of_samples(double samples, double within = 0.5) {
    const double wanted = samples - 1 + within + (rule_.divided ? 0.5 : rule_.first);
    // An extreme is the same on every ray that has a sample, and a short one may have none: its step is
    // unknown.
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

 private:
  FieldProbe& probe_;
  const RaysThroughBox& rays_;
  const volume::RaySteps& rule_;
  const March& march_;
  bool premultiplied_;
  std::vector<float> values_;
};

/// How many samples the longer ray has, going by what the shorter one tells of each. Where rays are short, at
/// the silhouette of the box, their length changes by a sample within a small part of a pixel, and counts of
/// samples by the geometry are off by one. Null: the rays do not agree whatever the number.
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
      // What does not grow with the way is a floor of the program's, and says nothing of a sample.
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

/// The shortest ray that shows anything, and agrees with the `longer` ones, whose samples are counted by it. At
/// the box's silhouette, where rays are shortest, the one that was looked for may just miss its pixel.
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
  const auto found = shortest_ray(table, march, longer);
  if (const auto* refusal = std::get_if<Refusal>(&found)) return *refusal;
  const auto& shortest = std::get<RayOfTable>(found);
  auto& entries = march.table.entries;
  entries.clear();
  for (const Rgba& colour : shortest.colours) {
    // Whatever more a sample had, a ray of many would look alike.
    if (shortest.samples > most_samples_of_shortest && amount(march, colour) > saturated) return no_short_ray;
    entries.push_back(march.shows_one_colour() ? colour : sample_of(march, colour, shortest.samples));
  }
  for (const RayOfTable& ray : longer) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const float seen = amount(march, ray.colours[i]);
      if (seen >= opaque) continue;
      // An opacity that does not grow with the way is that floor.
      const bool grows = seen > amount(march, shortest.colours[i]) + 1e-5F;
      entries[i] =
          grows ? sample_of(march, ray.colours[i], ray.samples) : Rgba{0, 0, 0, march.sum ? 1.0F : 0.0F};
    }
  }
  return std::nullopt;
}

std::optional<float> half_seen_value(const March& march, const volume::Vec3& way) {
  float nearest = 0.48F;
  std::optional<float> value;
  const volume::TransferFunction& table = march.table;
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const float seen = amount(march, ray_of(march, table.entries[i], steps_of_way(march.steps, way)));
    if (std::abs(seen - 0.5F) >= nearest) continue;
    nearest = std::abs(seen - 0.5F);
    value = value_at({table.low, table.high}, double(i) / double(table.entries.size() - 1));
  }
  return value;
}

}  // namespace understudy::spu
