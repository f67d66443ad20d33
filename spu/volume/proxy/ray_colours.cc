// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ray_colours.h"

#include <algorithm>
#include <cmath>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/proxy/field_probe.h"

namespace understudy::spu {

using volume::Rgba;

float value_at(const std::array<float, 2>& range, double place) {
  return float(range[0] + place * (double(range[1]) - range[0]));
}

std::vector<float> values_over(const std::array<float, 2>& range, int count) {
  std::vector<float> values;
  values.reserve(std::size_t(count));
  for (int i = 0; i < count; ++i) values.push_back(value_at(range, double(i) / (count - 1)));
  return values;
}

bool reached(const Rgba& fragment) {
  return fragment[3] != no_fragment;
}

Rgba premultiplied(Rgba fragment, bool already) {
  if (!reached(fragment)) return {};
  for (std::size_t c = 0; c < 3 && !already; ++c) fragment[c] *= fragment[3];
  return fragment;
}

bool premultiplied_already(const MarchContext& measured, const March& march) {
  return measured.run.pipeline().blending.premultiplied || march.alpha_twice || march.background;
}

bool multiplies_by_alpha(const Pipeline& pipeline) {
  return !pipeline.blending.premultiplied && !pipeline.target.floating;
}

bool grow_with_alpha(const std::vector<Rgba>& through, const std::vector<Rgba>& briefly) {
  constexpr float least_alpha = 0.02F;
  constexpr double clearly = 0.1;
  double from_same = 0;
  double from_multiplied = 0;
  for (std::size_t i = 0; i < through.size(); ++i) {
    const Rgba& longer = through[i];
    const Rgba& shorter = briefly[i];
    if (!(shorter[3] > least_alpha && longer[3] > 1.2F * shorter[3])) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      from_same += std::abs(longer[c] - shorter[c]);
      from_multiplied += std::abs(longer[c] * shorter[3] / longer[3] - shorter[c]);
    }
  }
  return from_multiplied < clearly * from_same;
}

float brightest_channel(const Rgba& colour) {
  return std::max({colour[0], colour[1], colour[2]});
}

bool is_black_where_even(const March& march) {
  return march.light && march.light->even[0] == 0;
}

Rgba even_sample(const March& march, float value) {
  Rgba sample = table_at(march.table, value);
  for (std::size_t c = 0; c < 3 && march.light; ++c) sample[c] *= march.light->even[c];
  return sample;
}

Rgba sample_of(const March& march, const Rgba& ray, double n) {
  if (march.sum) return {float(ray[0] / n), float(ray[1] / n), float(ray[2] / n), 1};
  if (n == 1) return ray;
  Rgba sample{};
  sample[3] = float(-std::expm1(std::log1p(-std::min(double(ray[3]), 1.0)) / n));
  const float part = ray[3] > 0 ? sample[3] / ray[3] : float(1 / n);
  for (std::size_t c = 0; c < 3; ++c) sample[c] = ray[c] * part;
  return sample;
}

Rgba ray_of(const March& march, const Rgba& sample, double n) {
  if (march.sum) {
    Rgba ray{0, 0, 0, march.sum->alpha};
    for (std::size_t c = 0; c < 3; ++c) ray[c] = std::min(float(sample[c] * n), march.sum->ceiling);
    return ray;
  }
  Rgba ray{};
  ray[3] = float(-std::expm1(n * std::log1p(-std::min(double(sample[3]), 1.0))));
  const float times = sample[3] > 0 ? ray[3] / sample[3] : float(n);
  for (std::size_t c = 0; c < 3; ++c) ray[c] = sample[c] * times;
  return ray;
}

float amount(const March& march, const Rgba& ray) {
  return march.sum ? brightest_channel(ray) / std::min(1.0F, march.sum->ceiling) : ray[3];
}

std::optional<float> one_alpha(const std::vector<Rgba>& through, const std::vector<Rgba>& briefly) {
  constexpr float same = 1e-3F;
  const float alpha = through.front()[3];
  if (!(alpha > 0)) return std::nullopt;
  for (const auto* rays : {&through, &briefly}) {
    for (const Rgba& ray : *rays) {
      if (!(std::abs(ray[3] - alpha) <= same)) return std::nullopt;
    }
  }
  return alpha;
}

std::optional<PlainSum> plain_sum(const std::vector<Rgba>& through, const std::vector<Rgba>& briefly) {
  const auto alpha = one_alpha(through, briefly);
  if (!alpha) return std::nullopt;
  PlainSum sum{*alpha};
  float largest = 0;
  for (const Rgba& ray : through) largest = std::max(largest, brightest_channel(ray));
  // A sum that several values reach is the program's ceiling.
  const auto reached_by = std::count_if(through.begin(), through.end(), [&](const Rgba& ray) {
    return largest - brightest_channel(ray) <= 1e-6F * largest;
  });
  if (reached_by > 1) sum.ceiling = largest;
  return sum;
}

}  // namespace understudy::spu
