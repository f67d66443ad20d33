// SPDX-License-Identifier: Apache-2.0
#include "volume/error_bound/medium_variation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace understudy::volume {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

using PlainColour = std::array<double, 3>;

double greatest_channel(const PlainColour& a) {
  return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

PlainColour colour_difference(const PlainColour& a, const PlainColour& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

}  // namespace

/// The medium between two neighbouring entries of the images' function.
struct MediumVariation::Piece {
  double depth_low = 0, depth_high = 0;              ///< K at its ends
  double depth_slope_low = 0, depth_slope_high = 0;  ///< K' at its ends
  double depth_curve = 0;                            ///< the greatest K''
  bool visible = false;
  PlainColour low{}, high{};              ///< X at its ends
  PlainColour slope_low{}, slope_high{};  ///< X' at its ends
  double colour_curve = 0;                ///< the greatest |X''|
};

namespace {

/// Steeper slopes are capped at this: the error is then bounded by ranges instead of slopes.
constexpr double steepest_counted = 1e9;

double capped(double slope) {
  return std::clamp(slope, -steepest_counted, steepest_counted);
}

double slope_of_depth(double step, double opacity, double rise) {
  return rise == 0     ? 0
         : opacity < 1 ? capped(step * rise / (1 - opacity))
                       : std::copysign(steepest_counted, rise);
}

template <typename Piece>
void set_colours(const std::array<double, 4>& low, const std::array<double, 4>& high, Piece& piece) {
  const double a = std::min(low[3], 1.0), b = std::min(high[3], 1.0);
  piece.visible = a > 0 || b > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!piece.visible) continue;
    piece.low[k] = a > 0 ? low[k] / a : high[k] / b;
    piece.high[k] = b > 0 ? high[k] / b : low[k] / a;
    // X' is this over the squared opacity, so its sign is constant. Float rounding does not count as a slope.
    double numerator = (high[k] - low[k]) * a - low[k] * (b - a);
    if (std::abs(numerator) <= 4e-7 * (std::abs(high[k] * a) + std::abs(low[k] * b))) numerator = 0;
    const auto slope = [&](double opacity) {
      if (numerator == 0) return piece.high[k] - piece.low[k];
      return opacity > 0 ? capped(numerator / (opacity * opacity)) : std::copysign(steepest_counted, numerator);
    };
    piece.slope_low[k] = slope(a);
    piece.slope_high[k] = slope(b);
    const double least = std::min(a, b);
    if (numerator != 0)
      piece.colour_curve =
          std::max(piece.colour_curve,
                   least > 0 ? 2 * std::abs(numerator * (b - a)) / (least * least * least) : steepest_counted);
  }
}

/// `in_function`: entries of `function` per entry of the images' function.
template <typename Piece>
Piece piece_of(const TransferFunction& function, double step, std::size_t entry, double in_function) {
  const auto low = entry_at(function, double(entry) * in_function);
  const auto high = entry_at(function, double(entry + 1) * in_function);
  Piece piece;
  const double a = std::min(low[3], 1.0), b = std::min(high[3], 1.0);
  piece.depth_low = -step * std::log1p(-a);
  piece.depth_high = -step * std::log1p(-b);
  piece.depth_slope_low = slope_of_depth(step, a, b - a);
  piece.depth_slope_high = slope_of_depth(step, b, b - a);
  piece.depth_curve =
      std::max(piece.depth_slope_low * piece.depth_slope_low, piece.depth_slope_high * piece.depth_slope_high) /
      step;
  set_colours(low, high, piece);
  return piece;
}

/// Interpolates colours linearly across pieces where nothing is visible.
template <typename Piece>
void fill_invisible(std::vector<Piece>& pieces) {
  for (std::size_t i = 0; i < pieces.size();) {
    std::size_t end = i;
    while (end < pieces.size() && !pieces[end].visible) ++end;
    const PlainColour from = i > 0 ? pieces[i - 1].high : end < pieces.size() ? pieces[end].low : PlainColour{};
    const PlainColour to = end < pieces.size() ? pieces[end].low : from;
    for (std::size_t j = i; j < end; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto length = double(end - i);
        pieces[j].low[k] = std::lerp(from[k], to[k], double(j - i) / length);
        pieces[j].high[k] = std::lerp(from[k], to[k], double(j + 1 - i) / length);
        pieces[j].slope_low[k] = pieces[j].slope_high[k] = (to[k] - from[k]) / length;
      }
    }
    i = std::max(end, i + 1);
    while (i < pieces.size() && pieces[i].visible) ++i;
  }
}

/// Extremes over several pieces.
struct Extremes {
  double depth = 0, least_depth = infinite, depth_slope = 0, colour_slope = 0;
  double depth_curve = 0, colour_curve = 0;
  PlainColour low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};

  void add(const Extremes& other) {
    depth = std::max(depth, other.depth);
    least_depth = std::min(least_depth, other.least_depth);
    depth_slope = std::max(depth_slope, other.depth_slope);
    colour_slope = std::max(colour_slope, other.colour_slope);
    depth_curve = std::max(depth_curve, other.depth_curve);
    colour_curve = std::max(colour_curve, other.colour_curve);
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], other.low[k]);
      high[k] = std::max(high[k], other.high[k]);
    }
  }
};

template <typename Piece>
Extremes extremes_of(const Piece& piece, const Piece* before) {
  Extremes all;
  all.depth = std::max(piece.depth_low, piece.depth_high);
  all.least_depth = std::min(piece.depth_low, piece.depth_high);
  all.depth_slope = std::max(std::abs(piece.depth_slope_low), std::abs(piece.depth_slope_high));
  all.colour_slope = std::max(greatest_channel(piece.slope_low), greatest_channel(piece.slope_high));
  all.depth_curve = piece.depth_curve;
  all.colour_curve = piece.colour_curve;
  for (std::size_t k = 0; k < 3; ++k) {
    all.low[k] = std::min(piece.low[k], piece.high[k]);
    all.high[k] = std::max(piece.low[k], piece.high[k]);
  }
  // Colours may jump where the opacity is 0.
  if (before != nullptr && greatest_channel(colour_difference(piece.low, before->high)) > 1e-6)
    all.colour_slope = steepest_counted;
  return all;
}

/// Jumps of slopes.
struct Kinks {
  double depth = 0;
  PlainColour colour{};

  void add(const Kinks& other, double sign = 1) {
    depth += sign * other.depth;
    for (std::size_t k = 0; k < 3; ++k) colour[k] += sign * other.colour[k];
  }
};

/// The jumps of slopes between two neighbouring pieces; null: beyond an end of the function, where everything
/// is constant. At entries that opacity_corrected() inserts, slopes differ by rounding only, which does not
/// count.
template <typename Piece>
Kinks kinks_between(const Piece* before, const Piece* behind) {
  const auto jump = [](double a, double b) {
    constexpr double rounding = 1e-6;
    const double size = std::abs(a - b);
    return size > rounding * (std::abs(a) + std::abs(b)) ? size : 0;
  };
  Kinks kinks{jump(before ? before->depth_slope_high : 0, behind ? behind->depth_slope_low : 0), {}};
  for (std::size_t k = 0; k < 3; ++k)
    kinks.colour[k] = jump(before ? before->slope_high[k] : 0, behind ? behind->slope_low[k] : 0);
  return kinks;
}

}  // namespace

/// Bounds over any range of pieces.
class MediumVariation::Ranges {
 public:
  explicit Ranges(const std::vector<Piece>& pieces)
      : first_kinks_(kinks_between<Piece>(nullptr, &pieces.front())),
        last_kinks_(kinks_between<Piece>(&pieces.back(), nullptr)) {
    std::vector<Extremes>& single = extremes_.emplace_back();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Piece* const before = i > 0 ? &pieces[i - 1] : nullptr;
      single.push_back(extremes_of(pieces[i], before));
      kinks_.push_back(i > 0 ? kinks_.back() : Kinks{});
      if (before) kinks_.back().add(kinks_between(before, &pieces[i]));
    }
    for (std::size_t length = 1; 2 * length <= pieces.size(); length *= 2) {
      const std::vector<Extremes>& half = extremes_.back();
      std::vector<Extremes> whole;
      for (std::size_t i = 0; i + 2 * length <= pieces.size(); ++i) {
        whole.push_back(half[i]);
        whole.back().add(half[i + length]);
      }
      extremes_.push_back(std::move(whole));
    }
  }

  /// Over the pieces first .. end - 1, and beyond the function's low (`below`) and high (`above`) end.
  MediumBounds over(std::size_t first, std::size_t end, bool below, bool above) const {
    const auto level = std::size_t(std::bit_width(std::max<std::size_t>(end - first, 1)) - 1);
    Extremes all = extremes_[level][first];
    all.add(extremes_[level][end - (std::size_t(1) << level)]);
    MediumBounds bounds;
    bounds.depth = all.depth;
    bounds.depth_range = all.depth == all.least_depth ? 0 : all.depth - all.least_depth;  // may be infinite
    bounds.depth_slope = all.depth_slope;
    bounds.depth_curve = all.depth_curve;
    bounds.colour_range = greatest_channel(colour_difference(all.high, all.low));
    bounds.colour_slope = all.colour_slope;
    bounds.colour_curve = all.colour_curve;
    Kinks kinks = kinks_[end - 1];
    kinks.add(kinks_[first], -1);
    if (below) kinks.add(first_kinks_);
    if (above) kinks.add(last_kinks_);
    bounds.depth_kinks = kinks.depth;
    bounds.colour_kinks = greatest_channel(kinks.colour);
    return bounds;
  }

 private:
  std::vector<std::vector<Extremes>> extremes_;  ///< of 1, 2, 4, ... pieces, by the first
  std::vector<Kinks> kinks_;                     ///< prefix sums, up to and including the low end of a piece
  Kinks first_kinks_, last_kinks_;               ///< at the function's ends
};

namespace {

void check(const TransferFunction& function) {
  for (const Rgba& entry : function.entries) {
    const bool coloured = entry[0] != 0 || entry[1] != 0 || entry[2] != 0;
    if (std::ranges::min(entry) < 0 || entry[3] > 1 || (entry[3] == 0 && coloured))
      throw std::invalid_argument(
          "bounds of the error are for media whose opacities lie in [0, 1], without negative colours and "
          "without "
          "colour where the opacity is 0");
  }
}

}  // namespace

MediumVariation::MediumVariation(const TransferFunction& function, double step,
                                 const TransferFunction& of_images)
    : function_(function),
      step_(step),
      in_function_(double(function.entries.size() - 1) / double(of_images.entries.size() - 1)),
      entries_(of_images.entries.size()) {
  check(function);
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < entries_; ++i) {
    pieces.push_back(piece_of<Piece>(function, step, i, in_function_));
    brightest_ =
        std::max({brightest_, greatest_channel(pieces.back().low), greatest_channel(pieces.back().high)});
  }
  fill_invisible(pieces);
  for (const Piece& piece : pieces) unseen_.push_back({piece.low, piece.high});
  const Ranges ranges(pieces);
  constexpr double least_radius = 1.0 / 16;
  radii_.push_back(least_radius);
  while (radii_.back() < 2 * double(entries_)) radii_.push_back(radii_.back() * std::sqrt(2.0));
  by_radius_.resize(radii_.size());
  const auto last = double(pieces.size());
  tbb::parallel_for(std::size_t(0), radii_.size(), [&](std::size_t r) {
    for (std::size_t i = 0; i + 1 < entries_; ++i) {
      const double low = double(i) - radii_[r], high = double(i) + 1 + radii_[r];
      by_radius_[r].push_back(ranges.over(std::size_t(std::floor(std::max(low, 0.0))),
                                          std::size_t(std::ceil(std::min(high, last))), low<0, high> last));
    }
  });
}

MediumPoint MediumVariation::at(double place) const {
  const auto entry = entry_at(function_, place * in_function_);
  const double opacity = std::min(entry[3], 1.0);
  MediumPoint point{-step_ * std::log1p(-opacity), {}};
  const auto piece = std::min(std::size_t(place), entries_ - 2);
  for (std::size_t k = 0; k < 3; ++k)
    point.colour[k] = opacity > 0 ? entry[k] / opacity
                                  : std::lerp(unseen_[piece].low[k], unseen_[piece].high[k],
                                              std::clamp(place - double(piece), 0.0, 1.0));
  return point;
}

const MediumBounds& MediumVariation::around(std::size_t entry, double radius) const {
  const auto found = std::ranges::lower_bound(radii_, radius);
  const auto index = std::min(std::size_t(found - radii_.begin()), radii_.size() - 1);
  return by_radius_[index][std::min(entry, entries_ - 2)];
}

}  // namespace understudy::volume
