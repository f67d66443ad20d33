// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace understudy::volume {
namespace {

bool dark(const std::array<double, 4>& entry) {
  return std::all_of(entry.begin(), entry.end(), [](double v) { return v == 0; });
}

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace

Medium::Medium(double low, double high, std::vector<std::array<double, 4>> entries, double distance)
    : entries_(std::move(entries)), distance_(distance) {
  require(!entries_.empty(), "a table needs an entry");
  require(std::isfinite(low) && std::isfinite(high) && (entries_.size() == 1 || low < high),
          "a table's range must be finite, and its low end below its high end");
  for (const auto& entry : entries_) {
    for (const double v : entry)
      require(std::isfinite(v) && v >= 0, "a table's entries must be finite and not negative");
    require(distance_ == 0 || entry[3] <= 1, "an opacity must not be above 1");
  }
  const std::size_t n = entries_.size();
  for (std::size_t i = 0; i < n; ++i)
    control_points_.push_back(n == 1 ? low : low + (high - low) * (double(i) / double(n - 1)));
  for (std::size_t segment = 0; segment <= n; ++segment) {
    const auto& below = entries_[segment == 0 ? 0 : segment - 1];
    const auto& above = entries_[std::min(segment, n - 1)];
    empty_.push_back(dark(below) && dark(above) ? 1 : 0);
    opaque_.push_back(distance_ > 0 && below[3] == 1 && above[3] == 1 ? 1 : 0);
  }
}

Medium Medium::of_rates(double low, double high, const std::vector<Rate>& entries) {
  std::vector<std::array<double, 4>> flat;
  flat.reserve(entries.size());
  for (const Rate& rate : entries)
    flat.push_back({rate.source[0], rate.source[1], rate.source[2], rate.extinction});
  return {low, high, std::move(flat), 0};
}

Medium Medium::of_samples(const TransferFunction& function, double distance) {
  require(distance > 0 && std::isfinite(distance), "the distance between samples must be positive");
  std::vector<std::array<double, 4>> entries;
  entries.reserve(function.entries.size());
  for (const Rgba& entry : function.entries) entries.push_back({entry[0], entry[1], entry[2], entry[3]});
  return {function.low, function.high, std::move(entries), distance};
}

std::size_t Medium::segment_of(double value) const {
  return std::size_t(std::lower_bound(control_points_.begin(), control_points_.end(), value) -
                     control_points_.begin());
}

std::array<double, 4> Medium::entry_at(std::size_t segment, double value) const {
  if (segment == 0) return entries_.front();
  if (segment == entries_.size()) return entries_.back();
  const double low = control_points_[segment - 1];
  const double s = std::clamp((value - low) / (control_points_[segment] - low), 0.0, 1.0);
  const auto& below = entries_[segment - 1];
  const auto& above = entries_[segment];
  std::array<double, 4> entry{};
  for (std::size_t k = 0; k < 4; ++k) entry[k] = (1 - s) * below[k] + s * above[k];
  return entry;
}

bool Medium::opaque_at(std::size_t segment, double value) const {
  return opaque(segment) || (distance_ > 0 && entry_at(segment, value)[3] == 1);
}

Rate Medium::rate(std::size_t segment, double value) const {
  const auto entry = entry_at(segment, value);
  if (distance_ == 0) return {{entry[0], entry[1], entry[2]}, entry[3]};
  return rate_of_sample(entry, distance_);
}

double Medium::noise(std::size_t segment) const {
  const std::size_t below = segment == 0 ? 0 : segment - 1;
  const std::size_t above = std::min(segment, control_points_.size() - 1);
  const double low = control_points_[below], high = control_points_[above];
  double greatest = std::max(rate(segment, low).extinction, rate(segment, high).extinction);
  if (distance_ > 0) {
    // One ulp of an opacity near 1 is many of its transparency, whose logarithm gives the extinction.
    const double opacity = std::max(entry_at(segment, low)[3], entry_at(segment, high)[3]);
    greatest = std::max(greatest, opacity / (1 - opacity) / distance_);
  }
  const double width = high - low;
  return 8 * std::numeric_limits<double>::epsilon() * greatest *
         (1 + (width > 0 ? std::max(std::abs(low), std::abs(high)) / width : 0));
}

Rate rate_of_sample(const std::array<double, 4>& colour, double distance) {
  const double opacity = std::min(colour[3], 1 - std::numeric_limits<double>::epsilon() / 2);
  const double depth = -std::log1p(-opacity);  // optical depth of one layer
  // A homogeneous layer shows source / extinction * opacity.
  const double per_colour = (opacity > 0 ? depth / opacity : 1) / distance;
  return {{colour[0] * per_colour, colour[1] * per_colour, colour[2] * per_colour}, depth / distance};
}

}  // namespace understudy::volume
