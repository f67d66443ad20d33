// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ray_probes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "spu/volume/proxy/ray_colours.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr int bands = 24;  ///< of two rows each, on which samples are counted
constexpr float same_but_for_rounding = 0.02F;
/// Rise of the fields that reveal lighting, as a fraction of the range of values: any gradient suffices,
/// however small.
constexpr float slight_rise = 1e-5F;

/// Whether the colour jumps at `value`: a slope there does not reveal lighting.
bool is_at_step(const MarchContext& measured, FieldProbe& probe, const Ray& ray, float value) {
  const float rise = slight_rise * (measured.range[1] - measured.range[0]);
  const std::array around{std::max(value - rise, measured.range[0]), value,
                          std::min(value + rise, measured.range[1])};
  const auto colours = probe.at(ray.x, ray.y, around);
  return !(largest_difference(colours[0], colours[1]) <= same_but_for_rounding &&
           largest_difference(colours[1], colours[2]) <= same_but_for_rounding);
}

}  // namespace

std::vector<Ray> rays_of_length(const RaysThroughBox& rays, const volume::RaySteps& steps, double wanted) {
  constexpr int directions = 16;
  const auto length_at = [&](double x, double y) {
    const auto way = rays.way(x, y);
    return way ? steps_of_way(steps, *way) : 0.0;
  };
  const auto middle = rays.middle();
  const double mx = std::clamp(middle[0], -0.9, 0.9);
  const double my = std::clamp(middle[1], -0.9, 0.9);
  std::vector<Ray> found(directions, Ray{mx, my, length_at(mx, my)});
  for (int direction = 0; direction < directions; ++direction) {
    Ray& best = found[std::size_t(direction)];
    const double angle = 2 * M_PI / directions * direction + 0.1;
    double inside = 0;
    double outside = 3;
    for (int halving = 0; halving < 24; ++halving) {
      const double reach = (inside + outside) / 2;
      const double x = mx + reach * std::cos(angle);
      const double y = my + reach * std::sin(angle);
      const bool in_view = std::abs(x) < 0.99 && std::abs(y) < 0.99;
      const double length = in_view ? length_at(x, y) : 0;
      if (length > 0 && std::abs(length - wanted) < std::abs(best.length - wanted)) best = {x, y, length};
      (length > wanted ? inside : outside) = reach;
    }
  }
  return found;
}

Ray ray_of_length(const RaysThroughBox& rays, const volume::RaySteps& steps, double wanted) {
  return std::ranges::min(rays_of_length(rays, steps, wanted), {},
                          [&](const Ray& ray) { return std::abs(ray.length - wanted); });
}

bool depends_on_gradient(const MarchContext& measured, FieldProbe& probe, const Ray& ray, float value) {
  const float rise = slight_rise * (measured.range[1] - measured.range[0]);
  const std::array one{value};
  const Rgba flat = probe.at(ray.x, ray.y, one).front();
  const Rgba sloping = probe.at_slope(ray.x, ray.y, one, rise).front();
  return !(largest_difference(flat, sloping) <= same_but_for_rounding);
}

bool only_nearest_shows(const MarchContext& measured, FieldProbe& probe, const Ray& ray,
                        const std::vector<float>& values, const std::vector<Rgba>& nearest) {
  // An added fragment shows where fragments show most, and does not depend on values.
  constexpr std::size_t looked_at = 3;
  if (measured.run.pipeline().blending.replaces || probe.culls_faces()) return true;
  std::vector<std::size_t> most_visible(values.size());
  std::iota(most_visible.begin(), most_visible.end(), std::size_t{0});
  const auto seen = [&](std::size_t i) { return reached(nearest[i]) ? nearest[i] : Rgba{}; };
  std::ranges::sort(most_visible, std::greater{}, [&](std::size_t i) { return std::ranges::max(seen(i)); });
  most_visible.resize(std::min(most_visible.size(), looked_at));
  std::vector<float> shown;
  shown.reserve(most_visible.size());
  for (const std::size_t i : most_visible) shown.push_back(values[i]);
  const auto sums = probe.sums_at(ray.x, ray.y, shown);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!(largest_difference(sums[i], seen(most_visible[i])) <= 1e-6F)) return false;
  }
  return true;
}

std::optional<TranslucentRay> translucent_ray(const MarchContext& measured, FieldProbe& probe,
                                              const RaysThroughBox& rays, const volume::RaySteps& texels,
                                              const March& march, const std::vector<float>& values) {
  constexpr std::size_t looked_at = 4;
  // A nearly opaque ray may have been terminated early: a shorter one is better.
  constexpr std::array from_half{0.4F, 0.48F};
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  const Ray longest{middle[0], middle[1], way ? steps_of_way(texels, *way) : 0};
  std::vector<Ray> of_parts;
  std::vector<std::vector<Rgba>> fragments;
  for (const double part : {1.0, 0.25, 0.0625}) {
    const Ray ray = part == 1 ? longest : ray_of_length(rays, texels, part * longest.length);
    of_parts.push_back(ray);
    fragments.push_back(probe.at(ray.x, ray.y, values));
  }
  for (const float too_far_from_half : from_half) {
    for (std::size_t part = 0; part < of_parts.size(); ++part) {
      std::vector<std::pair<float, float>> by_distance;  // distance from half, and the value
      for (std::size_t i = 0; i < values.size(); ++i) {
        const float distance = std::abs(amount(march, fragments[part][i]) - 0.5F);
        if (reached(fragments[part][i]) && distance < too_far_from_half)
          by_distance.emplace_back(distance, values[i]);
      }
      std::ranges::sort(by_distance);
      by_distance.resize(std::min(by_distance.size(), looked_at));
      for (const auto& [distance, value] : by_distance) {
        if (!is_at_step(measured, probe, of_parts[part], value)) return TranslucentRay{of_parts[part], value};
      }
    }
  }
  return std::nullopt;
}

namespace {

/// Returns the opacity beyond which rays are not counted: one more sample makes no difference there, or
/// programs have terminated the ray. Some do so at 0.95 or 0.98: if enough rays let more through, the others do
/// not count.
double most_counted_opacity(const std::vector<double>& opacities) {
  constexpr double nearly_opaque = 0.99;
  constexpr double surely_before_the_stop = 0.9;
  const auto below = [&](double most) {
    return std::ranges::count_if(opacities, [=](double opacity) { return opacity <= most; });
  };
  return 4 * below(surely_before_the_stop) >= below(nearly_opaque) ? surely_before_the_stop : nearly_opaque;
}

}  // namespace

std::variant<std::vector<CountedRay>, std::string> counted_rays(const MarchContext& measured, FieldProbe& probe,
                                                                const RaysThroughBox& rays,
                                                                const March& march) {
  const bool already = premultiplied_already(measured, march);
  std::vector<CountedRay> counted;
  std::vector<double> amounts;
  std::vector<Rgba> colours;
  for (int band = 0; band < bands; ++band) {
    const int y = std::clamp((2 * band + 1) * probe.height() / (2 * bands), 0, std::max(0, probe.height() - 2));
    const auto fragments = probe.pixels({0, y, probe.width(), 2}, march.translucent);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (!reached(fragments[i])) continue;
      const int column = int(i) % probe.width();
      const int row = y + int(i) / probe.width();
      const auto way = rays.way(probe.x_of(column), probe.y_of(row));
      if (!way) continue;
      counted.push_back({*way, 0, probe.left() + column, probe.bottom() + row});
      colours.push_back(premultiplied(fragments[i], already));
      amounts.push_back(double(amount(march, colours.back())));
    }
  }
  if (!march.sum) {
    const double most_counted = most_counted_opacity(amounts);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < counted.size(); ++i) {
      if (amounts[i] > most_counted) continue;
      counted[kept] = counted[i];
      colours[kept] = colours[i];
      amounts[kept++] = amounts[i];
    }
    counted.resize(kept);
    colours.resize(kept);
    amounts.resize(kept);
  }
  if (counted.size() < 64) return "too little of the box is in view to measure its rays";
  const auto most = std::max_element(amounts.begin(), amounts.end());
  const std::vector<double> counts = march.sum ? counts_from_amounts(amounts) : counts_from_opacities(amounts);
  if (counts.empty() && march.sum) return "the colours of a ray's samples do not add up";
  if (counts.empty()) return "the samples of a ray are not composed by over (a plain sum, or lighting)";
  // Colour over opacity must be the same as for one sample.
  const std::size_t longest = std::size_t(most - amounts.begin());
  float brightest = brightest_channel(colours[longest]);
  // Colours that are seen over a background are as exact as that background is bright.
  if (march.background)
    brightest = std::max(brightest, brightest_channel(over_background(*march.background, Rgba{})));
  const float most_off = 0.01F * brightest;
  for (std::size_t i = 0; i < counted.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = double(colours[longest][c]) / *most * amounts[i];
      if (std::abs(colours[i][c] - expected) > most_off)
        return "the colours of a ray's samples are not composed by over";
    }
    counted[i].samples = counts[i];
  }
  return counted;
}

double shortest_seen(FieldProbe& probe, const RaysThroughBox& rays, const volume::RaySteps& texels, float value,
                     const Rgba& shown) {
  const std::array one{value};
  const auto middle = rays.middle();
  const double mx = std::clamp(middle[0], -0.9, 0.9);
  const double my = std::clamp(middle[1], -0.9, 0.9);
  std::vector<double> lengths;
  for (int direction = 0; direction < 5; ++direction) {
    const double angle = 2 * M_PI / 5 * direction + 0.1;
    double inside = 0;
    double outside = 3;
    double length = 0;
    for (int halving = 0; halving < 16; ++halving) {
      const double reach = (inside + outside) / 2;
      const double x = mx + reach * std::cos(angle);
      const double y = my + reach * std::sin(angle);
      const bool in_view = std::abs(x) < 0.99 && std::abs(y) < 0.99;
      const auto way = rays.way(x, y);
      const bool seen =
          in_view && way && largest_difference(probe.at(x, y, one).front(), shown) < 0.01F * shown[3];
      (seen ? inside : outside) = reach;
      if (seen) length = steps_of_way(texels, *way);
    }
    lengths.push_back(length);
  }
  // Where the window cuts off the box, rays stay long: the shortest of all is the silhouette's.
  return *std::min_element(lengths.begin(), lengths.end());
}

bool held_still(const MarchContext& measured, FieldProbe& probe, const March& march) {
  return !march.jitter || hold_still(measured.run, probe, *march.jitter);
}

}  // namespace understudy::spu
